"use strict";
(() => {
  // Tables: a click on a head sorts by its column; what has no value comes last, whatever the direction.
  const collator = new Intl.Collator("en", { numeric: true });

  function sortBy(table, column, descending) {
    const body = table.tBodies[0];
    const rows = Array.from(body.rows, (row) => {
      const cell = row.cells[column];
      return { row, text: cell.textContent.trim(), value: cell.dataset.value === undefined ? null : Number(cell.dataset.value) };
    });
    const numeric = rows.some((entry) => entry.value !== null);
    const missing = (entry) => (numeric ? entry.value === null : entry.text === "");
    rows.sort((a, b) => {
      if (missing(a) || missing(b)) return missing(a) - missing(b);
      const order = numeric ? a.value - b.value : collator.compare(a.text, b.text);
      return descending ? -order : order;
    });
    body.append(...rows.map((entry) => entry.row));
  }

  for (const table of document.querySelectorAll("figure.table table")) {
    const heads = Array.from(table.tHead.rows[0].cells);
    heads.forEach((head, column) => {
      head.firstElementChild.addEventListener("click", () => {
        const descending = head.getAttribute("aria-sort") === "ascending";
        heads.forEach((other) => other.removeAttribute("aria-sort"));
        head.setAttribute("aria-sort", descending ? "descending" : "ascending");
        sortBy(table, column, descending);
      });
    });
  }

  for (const input of document.querySelectorAll("input[data-filters]")) {
    const rows = Array.from(document.getElementById(input.dataset.filters).querySelectorAll("tbody tr"));
    input.addEventListener("input", () => {
      const wanted = input.value.toLowerCase();
      for (const row of rows) row.hidden = !row.cells[0].textContent.toLowerCase().includes(wanted);
    });
  }

  // Gallery: pictures and plans are stored as compressed text and unpacked when they are needed.
  const tiles = document.getElementById("tiles");
  if (!tiles) return;
  const { methods, scenes } = JSON.parse(document.getElementById("gallery-data").textContent);

  async function unpacked(text) {
    const bytes = Uint8Array.from(atob(text), (character) => character.charCodeAt(0));
    const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
    return new Response(stream).text();
  }

  /** Solved and all runs of one method, or of all (""). */
  function runsOf(scene, method) {
    const chosen = method === "" ? scene.runs : [scene.runs[methods.indexOf(method)]];
    return chosen.reduce((sum, runs) => (runs ? [sum[0] + runs[0], sum[1] + runs[1]] : sum), [0, 0]);
  }

  function verdictOf([solved, all]) {
    if (all === 0) return "";
    return solved === 0 ? "never" : solved === all ? "always" : "sometimes";
  }

  const observer = new IntersectionObserver(
    (entries) => {
      for (const { isIntersecting, target } of entries) {
        if (!isIntersecting) continue;
        observer.unobserve(target);
        unpacked(scenes[Number(target.dataset.scene)].picture).then((svg) => {
          const image = target.querySelector("img");
          image.src = URL.createObjectURL(new Blob([svg], { type: "image/svg+xml" }));
        });
      }
    },
    { rootMargin: "400px" },
  );

  function tileOf(scene, index) {
    const tile = document.createElement(scene.plan ? "button" : "div");
    if (scene.plan) {
      tile.type = "button";
      tile.title = "Play the plan";
    }
    tile.className = "tile";
    tile.dataset.scene = index;
    const picture = document.createElement(scene.picture ? "img" : "div");
    if (scene.picture) picture.alt = "";
    else picture.className = "empty";
    const name = document.createElement("b");
    name.textContent = scene.name;
    tile.append(picture, name, document.createElement("span"));
    if (scene.picture) observer.observe(tile);
    return tile;
  }

  const nodes = scenes.map(tileOf);
  tiles.append(...nodes);
  const [verdict, method, occlusion, name] = ["verdict", "method", "occlusion", "name"].map((id) => document.getElementById(id));
  const shown = document.getElementById("shown");

  function filter() {
    let count = 0;
    scenes.forEach((scene, i) => {
      const runs = runsOf(scene, method.value);
      const found = verdictOf(runs);
      const visible =
        found !== "" &&
        (verdict.value === "" || verdict.value === found) &&
        (occlusion.value === "" || occlusion.value === String(scene.occluded)) &&
        scene.name.toLowerCase().includes(name.value.toLowerCase());
      nodes[i].hidden = !visible;
      const label = nodes[i].lastElementChild;
      label.textContent = `${runs[0]} of ${runs[1]} runs solved`;
      label.className = found;
      count += visible;
    });
    shown.value = `${count} of ${scenes.length} scenes`;
  }

  for (const control of [verdict, method, occlusion, name]) control.addEventListener("input", filter);
  document.querySelector(".filters").addEventListener("submit", (event) => event.preventDefault());
  filter();

  const dialog = document.getElementById("player");
  const stage = dialog.querySelector(".stage");
  let player = null;

  tiles.addEventListener("click", async (event) => {
    const tile = event.target.closest("button.tile");
    if (!tile) return;
    const scene = scenes[Number(tile.dataset.scene)];
    const payload = JSON.parse(await unpacked(scene.plan));
    dialog.querySelector("h3").textContent = scene.name;
    dialog.querySelector("p").textContent = scene.caption;
    dialog.showModal();
    player = ManipuzzlePlayer.mount(stage, [payload]);
    if (!matchMedia("(prefers-reduced-motion: reduce)").matches) player.play();
  });
  dialog.querySelector("header button").addEventListener("click", () => dialog.close());
  dialog.addEventListener("click", (event) => {
    if (event.target === dialog) dialog.close();
  });
  dialog.addEventListener("close", () => {
    if (player) player.destroy();
    player = null;
    stage.replaceChildren();
  });
})();
