"""`manipuzzle data`: where the puzzles, the corpus, the policies and the studies are."""

import typer

from evaluate.commands.options import Json, application
from evaluate.output import print_json
from pcg.data_folder import data_folder

app = application()


@app.command()
def run(*, json: Json = False) -> bool:
    """Print the folder of the data that comes with manipuzzle; in a checkout it is data/.

    Example:  manipuzzle data
    To work on a copy:  cp -r "$(manipuzzle data)" data
    """
    folder = data_folder()
    if json:
        print_json({"folder": str(folder), "contents": sorted(path.name for path in folder.iterdir())})
    else:
        typer.echo(folder)
    return True
