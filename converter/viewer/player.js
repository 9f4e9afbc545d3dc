"use strict";
(() => {
  const SVG = "http://www.w3.org/2000/svg";
  const SPEEDS = [0.25, 0.5, 1, 2, 4, 8];
  const AGENT_SPEED = 1; // [m/s] at speed 1
  const NUDGE = 0.5; // [s] by an arrow key
  const LONGEST_FRAME = 0.1; // [s]: a page that was in the background goes on where it was
  const ICONS = {
    play: "M6 4l14 8-14 8z",
    pause: "M6 4h4v16H6zM14 4h4v16h-4z",
    back: "M5 4h3v16H5zM20 4v16L9 12z",
    forward: "M16 4h3v16h-3zM4 4l11 8-11 8z",
  };

  // Text always becomes text nodes, so names can hold anything.
  function element(name, properties = {}, children = []) {
    const node = document.createElement(name);
    for (const [key, value] of Object.entries(properties)) {
      if (key in node && key !== "list") node[key] = value;
      else node.setAttribute(key, value);
    }
    node.append(...children);
    return node;
  }

  function drawn(name, attributes = {}, children = []) {
    const node = document.createElementNS(SVG, name);
    for (const [key, value] of Object.entries(attributes)) node.setAttribute(key, String(value));
    node.append(...children);
    return node;
  }

  const distance = (a, b) => Math.hypot(b[0] - a[0], b[1] - a[1]);
  const clamp = (value, low, high) => Math.min(Math.max(value, low), high);
  const seconds = (value) => `${value.toFixed(1)} s`;

  /** One plan over time: where everything is at any moment. */
  class Timeline {
    constructor(plan) {
      this.plan = plan;
      this.steps = [];
      this.placements = []; // times at which objects are released [s]
      let time = plan.rests_s.first;
      let objects = plan.objects.map((object) => object.start);
      for (const segment of plan.segments) {
        const lengths = [0];
        for (let i = 1; i < segment.path.length; i++) {
          lengths.push(lengths[i - 1] + distance(segment.path[i - 1], segment.path[i]));
        }
        const length = lengths[lengths.length - 1];
        const [first, last] = [segment.path[0], segment.path[segment.path.length - 1]];
        const held = segment.carried;
        const offset = held === null ? null : [objects[held][0] - first[0], objects[held][1] - first[1]];
        const end = time + length / AGENT_SPEED;
        this.steps.push({ ...segment, lengths, start: time, end, objects, offset });
        if (held !== null) {
          objects = objects.slice();
          objects[held] = [last[0] + offset[0], last[1] + offset[1]];
          this.placements.push(end);
        }
        time = end + plan.rests_s.step;
      }
      this.duration = plan.segments.length ? time - plan.rests_s.step + plan.rests_s.last : 0;
      this.final = objects;
    }

    /** Agent, objects, index of the step (-1 before the first), index of what is held (null: nothing). */
    at(time) {
      const { steps, plan } = this;
      let low = 0;
      let high = steps.length; // steps[low - 1] is the last one that has begun
      while (low < high) {
        const middle = (low + high) >> 1;
        if (steps[middle].start <= time) low = middle + 1;
        else high = middle;
      }
      if (low === 0) return { agent: plan.agent.start, objects: plan.objects.map((o) => o.start), step: -1, held: null };
      const step = steps[low - 1];
      const agent = alongPath(step, (time - step.start) * AGENT_SPEED);
      const objects = step.objects.slice();
      if (step.carried !== null) {
        objects[step.carried] = [agent[0] + step.offset[0], agent[1] + step.offset[1]];
      }
      const held = time < step.end ? step.carried : null;
      return { agent, objects, step: low - 1, held };
    }

    /** How far the agent has driven [m]. */
    driven(time) {
      return this.steps.reduce((sum, step) => {
        const length = step.lengths[step.lengths.length - 1];
        return sum + clamp((time - step.start) * AGENT_SPEED, 0, length);
      }, 0);
    }
  }

  function alongPath({ path, lengths }, travelled) {
    if (travelled <= 0) return path[0];
    if (travelled >= lengths[lengths.length - 1]) return path[path.length - 1];
    let low = 1;
    let high = lengths.length - 1;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (lengths[middle] < travelled) low = middle + 1;
      else high = middle;
    }
    const share = (travelled - lengths[low - 1]) / (lengths[low] - lengths[low - 1] || 1);
    const [a, b] = [path[low - 1], path[low]];
    return [a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1])];
  }

  /** The picture of one plan. World coordinates; the picture's y points down. */
  class Stage {
    constructor(plan, timeline) {
      this.plan = plan;
      this.timeline = timeline;
      const { unit, colors, widths } = plan;
      this.agent = solid(plan.agent);
      this.objects = plan.objects.map(solid);
      this.paths = drawn("g", { class: "mzp-paths", fill: "none", "stroke-linecap": "round", "stroke-linejoin": "round" });
      this.lines = plan.segments.map(({ path, carried }) => {
        const width = (carried === null ? widths.move : widths.carry) * unit;
        const color = carried === null ? colors.move : plan.objects[carried].fill;
        const d = "M" + path.map(([x, y]) => `${x} ${-y}`).join("L") + (path.length > 1 ? "" : `L${path[0][0]} ${-path[0][1]}`);
        const stretch = [];
        if (carried !== null) {
          stretch.push(drawn("path", { d, stroke: colors.outline, "stroke-width": width + 2 * unit }));
        }
        stretch.push(drawn("path", { d, stroke: color, "stroke-width": width }));
        const line = drawn("g", {}, stretch);
        this.paths.append(line);
        return line;
      });
      this.subgoals = drawn("g", { class: "mzp-subgoals", "font-size": 0.8 * widths.text * unit, "text-anchor": "middle" });
      for (const place of plan.placements) this.subgoals.append(...subgoal(place, plan));
      const room = plan.room.flatMap(({ d, around, fill, outline }) => [
        ...(around === d ? [] : [drawn("path", { d: around, fill: outline })]),
        drawn("path", { d, fill }),
      ]);
      const title = drawn("title", {}, [`Scene ${plan.scene}, plan by ${plan.method}`]);
      this.svg = drawn("svg", { viewBox: plan.view.join(" "), role: "img" }, [
        title,
        drawn("rect", { x: plan.view[0], y: plan.view[1], width: plan.view[2], height: plan.view[3], fill: colors.page }),
        ...room,
        this.paths,
        ...this.objects.map((object) => object.node),
        this.agent.node,
        this.subgoals,
      ]);
      this.now = element("span", { className: "mzp-now" });
      this.figure = element("figure", { className: "mzp-stage" }, [
        this.svg,
        element("figcaption", {}, [
          element("span", { className: "mzp-name", textContent: `${plan.method}, seed ${plan.seed}` }),
          element("span", { className: "mzp-facts", textContent: facts(plan) }),
          this.now,
        ]),
      ]);
    }

    show(time) {
      const { agent, objects, step, held } = this.timeline.at(time);
      this.agent.move(agent, held !== null);
      this.objects.forEach((object, i) => object.move(objects[i], i === held));
      this.lines.forEach((line, i) => line.setAttribute("opacity", i <= step ? "1" : "0.35"));
      this.now.textContent = `${this.doing(time, step, held)} · ${this.timeline.driven(time).toFixed(1)} m`;
    }

    doing(time, step, held) {
      const { steps, duration } = this.timeline;
      if (!steps.length) return `no motion: ${this.plan.status}`;
      if (step < 0) return "start";
      if (time >= steps[steps.length - 1].end) return "done";
      const count = steps.length;
      if (held !== null) return `step ${step + 1} of ${count}: carrying ${this.plan.objects[held].name}`;
      if (steps[step].carried !== null) return `step ${step + 1} of ${count}: placed ${this.plan.objects[steps[step].carried].name}`;
      const next = steps.slice(step).find((other) => other.carried !== null);
      return `step ${step + 1} of ${count}: driving${next ? ` to ${this.plan.objects[next.carried].name}` : ""}`;
    }
  }

  /** Something that moves: its outline, which is wider while it is held, below its fill. */
  function solid({ d, around, held, fill, outline }) {
    const border = drawn("path", { d: around, fill: outline });
    const node = drawn("g", {}, [border, drawn("path", { d, fill })]);
    return {
      node,
      move([x, y], isHeld) {
        node.setAttribute("transform", `translate(${x} ${-y})`);
        border.setAttribute("d", isHeld ? held : around);
      },
    };
  }

  function subgoal({ position: [x, y], numbers }, { unit, colors, widths }) {
    const shown = numbers.slice(0, 3).join(",") + (numbers.length > 3 ? "…" : "");
    const height = 0.8 * widths.text * unit;
    const half = Math.max(0.62 * height, 0.31 * height * shown.length);
    return [
      drawn("rect", {
        x: x - half, y: -y - 0.62 * height, width: 2 * half, height: 1.24 * height, rx: 0.62 * height,
        fill: colors.subgoal, stroke: colors.badge, "stroke-width": unit,
      }),
      drawn("text", { x, y: -y + 0.35 * height, fill: colors.badge, "font-weight": 600 }, [shown]),
    ];
  }

  function facts(plan) {
    const places = `${plan.pick_places} pick-place${plan.pick_places === 1 ? "" : "s"}`;
    const planned = plan.time_s < 0.0995 ? `${(1000 * plan.time_s).toPrecision(2)} ms` : `${plan.time_s.toPrecision(2)} s`;
    return plan.segments.length
      ? `${plan.status} in ${planned}, ${places}, ${plan.path_length_m.toFixed(1)} m`
      : `${plan.status} after ${planned}`;
  }

  class ManipuzzlePlayer extends EventTarget {
    /** Mounts a player into `root`; see `converter.viewer_page` for the payloads. */
    static mount(root, payloads, options = {}) {
      return new ManipuzzlePlayer(root, payloads, options);
    }

    /** Mounts a player into every element that names its plans by `data-manipuzzle-plans`. */
    static mountAll(within) {
      return [...within.querySelectorAll("[data-manipuzzle-plans]")].map((root) => {
        const source = document.getElementById(root.dataset.manipuzzlePlans);
        return ManipuzzlePlayer.mount(root, JSON.parse(source.textContent), { keyboard: root.dataset.keyboard });
      });
    }

    constructor(root, payloads, { keyboard = "focus" } = {}) {
      super();
      const plans = Array.isArray(payloads) ? payloads : [payloads];
      this.root = root;
      this.timelines = plans.map((plan) => new Timeline(plan));
      this.stages = plans.map((plan, i) => new Stage(plan, this.timelines[i]));
      this.duration = Math.max(0, ...this.timelines.map((timeline) => timeline.duration));
      const placed = new Set(this.timelines.flatMap((timeline) => timeline.placements));
      this.stops = [...new Set([0, ...placed, this.duration])].sort((a, b) => a - b);
      this.time = 0;
      this.speed = 1;
      this.playing = false;
      this.#build([...placed]);
      this.#listen(keyboard);
      root.manipuzzlePlayer = this;
      this.#show();
    }

    play() {
      if (this.playing || this.duration === 0) return;
      if (this.time >= this.duration) this.time = 0;
      this.playing = true;
      let before = null;
      const frame = (now) => {
        if (!this.playing) return;
        const passed = before === null ? 0 : Math.min((now - before) / 1000, LONGEST_FRAME);
        before = now;
        this.time = Math.min(this.time + passed * this.speed, this.duration);
        if (this.time >= this.duration) this.playing = false;
        else this.request = requestAnimationFrame(frame);
        this.#show();
      };
      this.request = requestAnimationFrame(frame);
      this.#show();
    }

    pause() {
      this.playing = false;
      cancelAnimationFrame(this.request);
      this.#show();
    }

    toggle() {
      if (this.playing) this.pause();
      else this.play();
    }

    seek(time) {
      this.time = clamp(Number(time) || 0, 0, this.duration);
      this.#show();
    }

    /** Goes to the next (1) or last (-1) moment at which an object is put down, and pauses there. */
    step(direction) {
      const near = 1e-6;
      const stops = direction > 0 ? this.stops.filter((t) => t > this.time + near) : this.stops.filter((t) => t < this.time - near);
      const target = direction > 0 ? stops[0] : stops[stops.length - 1];
      this.pause();
      if (target !== undefined) this.seek(target);
    }

    setSpeed(speed) {
      this.speed = clamp(Number(speed) || 1, SPEEDS[0], SPEEDS[SPEEDS.length - 1]);
      this.controls.speed.value = String(this.speed);
      this.#show();
    }

    showPath(on) {
      this.controls.path.checked = on;
      for (const { paths } of this.stages) paths.style.display = on ? "" : "none";
    }

    showSubgoals(on) {
      this.controls.subgoals.checked = on;
      for (const { subgoals } of this.stages) subgoals.style.display = on ? "" : "none";
    }

    destroy() {
      this.pause();
      this.listening.abort();
      this.root.replaceChildren();
      this.root.classList.remove("mzp");
      delete this.root.manipuzzlePlayer;
    }

    #build(placed) {
      const button = (label, icon, className = "") => {
        const made = element("button", { type: "button", className, title: label, "aria-label": label });
        made.append(drawn("svg", { viewBox: "0 0 24 24", "aria-hidden": "true" }, [drawn("path", { d: ICONS[icon] })]));
        return made;
      };
      const check = (label) => element("input", { type: "checkbox", checked: true, "aria-label": label });
      this.controls = {
        back: button("Previous subgoal", "back"),
        play: button("Play", "play", "mzp-play"),
        forward: button("Next subgoal", "forward"),
        scrub: element("input", { type: "range", min: "0", max: String(this.duration), step: "any", value: "0", "aria-label": "Time" }),
        clock: element("span", { className: "mzp-clock" }),
        speed: element("select", { "aria-label": "Speed" }, SPEEDS.map((s) => element("option", { value: String(s), textContent: `${s}×` }))),
        path: check("Show path"),
        subgoals: check("Show subgoals"),
        status: element("span", { className: "mzp-hidden", role: "status" }),
      };
      const c = this.controls;
      c.speed.value = "1";
      const marks = element("div", { className: "mzp-marks", "aria-hidden": "true" });
      for (const time of placed) {
        const mark = element("i");
        mark.style.left = `${(100 * time) / this.duration}%`;
        marks.append(mark);
      }
      const keys = [["Space", "play, pause"], ["← →", "half a second"], ["Shift ← →", "subgoal"], ["Home End", "ends"], ["+ −", "speed"], ["P", "path"], ["S", "subgoals"]];
      const help = element("details", { className: "mzp-help" }, [
        element("summary", { textContent: "Keyboard" }),
        ...keys.flatMap(([key, use]) => [element("kbd", { textContent: key }), ` ${use}  `]),
      ]);
      const bar = element("div", { className: "mzp-bar", role: "group", "aria-label": "Playback" }, [
        element("div", { className: "mzp-buttons" }, [c.back, c.play, c.forward]),
        element("div", { className: "mzp-scrub" }, [marks, c.scrub]),
        c.clock,
        element("div", { className: "mzp-options" }, [
          element("label", {}, ["Speed", c.speed]),
          element("label", {}, [c.path, "Path"]),
          element("label", {}, [c.subgoals, "Subgoals"]),
        ]),
        help,
        c.status,
      ]);
      this.root.classList.add("mzp");
      this.root.replaceChildren(element("div", { className: "mzp-stages" }, this.stages.map((stage) => stage.figure)), bar);
    }

    #listen(keyboard) {
      this.listening = new AbortController();
      const { signal } = this.listening;
      const { back, play, forward, scrub, speed, path, subgoals } = this.controls;
      back.addEventListener("click", () => this.step(-1), { signal });
      play.addEventListener("click", () => this.toggle(), { signal });
      forward.addEventListener("click", () => this.step(1), { signal });
      scrub.addEventListener("input", () => this.seek(scrub.value), { signal });
      speed.addEventListener("change", () => this.setSpeed(speed.value), { signal });
      path.addEventListener("change", () => this.showPath(path.checked), { signal });
      subgoals.addEventListener("change", () => this.showSubgoals(subgoals.checked), { signal });
      const listener = keyboard === "page" ? document : this.root;
      if (keyboard !== "page") this.root.tabIndex = 0;
      listener.addEventListener("keydown", (event) => this.#key(event), { signal });
    }

    #key(event) {
      if (event.ctrlKey || event.altKey || event.metaKey || event.defaultPrevented) return;
      const name = event.target.tagName;
      // Selects keep all of their keys, buttons and the like those that press them.
      if (name === "SELECT" || name === "TEXTAREA" || (name === "INPUT" && !["range", "checkbox"].includes(event.target.type))) return;
      const pressing = name === "BUTTON" || name === "SUMMARY" || name === "A" || event.target.type === "checkbox";
      if (pressing && (event.key === " " || event.key === "Enter")) return;
      const faster = SPEEDS.find((s) => s > this.speed) ?? this.speed;
      const slower = SPEEDS.filter((s) => s < this.speed).pop() ?? this.speed;
      const actions = {
        " ": () => this.toggle(),
        ArrowLeft: () => (event.shiftKey ? this.step(-1) : this.seek(this.time - NUDGE)),
        ArrowRight: () => (event.shiftKey ? this.step(1) : this.seek(this.time + NUDGE)),
        Home: () => this.seek(0),
        End: () => this.seek(this.duration),
        "+": () => this.setSpeed(faster),
        "=": () => this.setSpeed(faster),
        "-": () => this.setSpeed(slower),
        p: () => this.showPath(!this.controls.path.checked),
        s: () => this.showSubgoals(!this.controls.subgoals.checked),
      };
      const action = actions[event.key.length === 1 ? event.key.toLowerCase() : event.key];
      if (!action) return;
      event.preventDefault();
      action();
    }

    #show() {
      const { play, scrub, clock, status } = this.controls;
      for (const stage of this.stages) stage.show(this.time);
      const label = this.playing ? "Pause" : "Play";
      if (play.title !== label) {
        play.title = label;
        play.setAttribute("aria-label", label);
        play.querySelector("path").setAttribute("d", ICONS[label.toLowerCase()]);
      }
      scrub.value = String(this.time);
      const text = `${seconds(this.time)} of ${seconds(this.duration)}`;
      const doing = this.stages.map((stage) => stage.now.textContent).join("; ");
      scrub.setAttribute("aria-valuetext", `${text}, ${doing}`);
      clock.textContent = text;
      // What changes sixty times a second is not read out.
      if (!this.playing && status.textContent !== doing) status.textContent = doing;
      this.root.dataset.playing = String(this.playing);
      this.root.dataset.time = this.time.toFixed(3);
      this.dispatchEvent(new Event("change"));
    }
  }

  window.ManipuzzlePlayer = ManipuzzlePlayer;
  ManipuzzlePlayer.mountAll(document);
})();
