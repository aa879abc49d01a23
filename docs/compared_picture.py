"""Draw the verdicts of all models in one picture: images/models-compared.png.

python docs/compared_picture.py

The verdicts that it shows are kept in the file, where a test compares them with those of the page.
"""

import json
from pathlib import Path

import compared

from cyclosis.figures import style
from cyclosis.figures.looks import setting

IMAGE = Path(__file__).parent / "images" / "models-compared.png"
COLOURS = {"agrees": style.UP, "in part": "#bd9bdc", "does not": style.DOWN, "": style.PAPER}
SIZE = (160.0, 90.0)
"""Width and height in millimetres: those of a card on the front page."""


def main() -> None:
    """Write the picture."""
    verdicts = compared.verdicts()
    with setting(style.TYPE):
        figure = style.blank(*SIZE)
        ax = style.place(figure, 44.0, 8.0, SIZE[0] - 46.0, SIZE[1] - 18.0)
        for row, (title, cells) in enumerate(verdicts.items()):
            for column, verdict in enumerate(cells.values()):
                ax.add_patch(_square(column, row, COLOURS[verdict]))
                if verdict:
                    light = verdict != "in part"
                    ax.text(
                        column + 0.5, row + 0.52, verdict, ha="center", va="center", fontsize=9.0,
                        color="white" if light else style.INK,
                    )  # fmt: skip
            ax.text(-0.08, row + 0.52, title, ha="right", va="center", fontsize=11.0)
        for column, name in enumerate(compared.COLUMNS):
            ax.text(column + 0.5, -0.25, name, ha="center", va="bottom", fontsize=12.0)
        ax.set_xlim(0, len(compared.COLUMNS))
        ax.set_ylim(len(verdicts), 0)
        ax.axis("off")
        figure.savefig(IMAGE, dpi=150, metadata={"Description": json.dumps(verdicts)})


def _square(column: int, row: int, colour: str):
    from matplotlib.patches import Rectangle

    return Rectangle((column + 0.03, row + 0.06), 0.94, 0.88, facecolor=colour, edgecolor="none")


if __name__ == "__main__":
    main()
