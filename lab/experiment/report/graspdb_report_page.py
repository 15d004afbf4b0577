"""Pages of tables and figures, as HTML with inline SVG by matplotlib."""
import collections
import html
import os
import re

import matplotlib

matplotlib.use("svg")
matplotlib.rcParams.update({"svg.hashsalt": "graspdb", "svg.fonttype": "none", "font.size": 8, "axes.grid": True,
                            "axes.axisbelow": True, "grid.alpha": 0.3, "legend.frameon": False})
from matplotlib import pyplot  # noqa: E402  the backend must be chosen before

STYLE = """body { font: 15px/1.5 sans-serif; max-width: 60em; margin: 2em auto; padding: 0 1em; }
table { border-collapse: collapse; } td, th { padding: .2em .6em; border-bottom: 1px solid #ccc; text-align: right; }
td:first-child, th:first-child { text-align: left; } .wide { overflow-x: auto; }
figure { margin: 1em 0; } svg { max-width: 100%; height: auto; } pre { overflow-x: auto; background: #f4f4f4; padding: .5em; }"""


class Page:
    """Collects markup, and writes each figure into a file too."""

    def __init__(self, folder):
        self.folder = os.path.join(folder, "figures")
        self.parts = []
        self.names = collections.Counter()
        os.makedirs(self.folder, exist_ok=True)

    def add(self, markup):
        self.parts.append(markup + "\n")

    def chapter(self, heading, text):
        self.add(f"<h3>{html.escape(heading)}</h3>\n<p>{html.escape(text)}</p>")

    def figure(self, section, title, figure):
        name = re.sub("[^a-z0-9]+", "-", f"{section} {title}".lower())[:80].strip("-")
        self.names[name] += 1
        if self.names[name] > 1:
            name += f"-{self.names[name]}"
        path = os.path.join(self.folder, name + ".svg")
        figure.tight_layout()
        figure.savefig(path, metadata={"Date": None, "Title": title})
        pyplot.close(figure)
        with open(path, encoding="utf-8") as file:
            svg = file.read()
        self.add(f"<figure>{svg[svg.index('<svg'):]}</figure>")


def bars(page, section, title, unit, categories, series, end=None, chosen=()):
    """Horizontal bars: `series` are (name, values); None is no bar, `chosen` categories are bold."""
    height = 0.8 / len(series)
    drawn_height = 0.4 + len(categories) * max(0.22, 0.16 * len(series))  # inches
    figure, axes = pyplot.subplots(figsize=(7, 0.8 + drawn_height))
    for i, (name, values) in enumerate(series):
        places = [row + (i + 0.5) * height - 0.4 for row in range(len(categories))]
        drawn = axes.barh(places, [value if value is not None else 0 for value in values], height, label=name)
        axes.bar_label(drawn, [f"{value:.3g}{unit}" if value is not None else "" for value in values], padding=2)
    axes.set_yticks(range(len(categories)), categories)
    for label, category in zip(axes.get_yticklabels(), categories):
        label.set_fontweight("bold" if category in chosen else "normal")
    axes.invert_yaxis()
    largest = max((value for _, values in series for value in values if value is not None), default=0)
    axes.set_xlim(0, 1.12 * (end or largest or 1))  # wide enough for the numbers
    axes.set_title(title)
    if len(series) > 1:
        axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.25 / drawn_height), ncols=len(series))
    page.figure(section, title, figure)


def lines(page, section, title, x_label, y_label, series):
    figure, axes = pyplot.subplots(figsize=(7, 3.4))
    for name, points in series:
        axes.plot([p[0] for p in points], [p[1] for p in points], label=name)
    axes.set(title=title, xlabel=x_label, ylabel=y_label, ylim=(0, 1.02))
    axes.legend()
    page.figure(section, title, figure)


def table(rows):
    cells = ["".join(f"<{tag}>{html.escape(str(cell))}</{tag}>" for cell in row)
             for row, tag in zip(rows, ["th"] + ["td"] * (len(rows) - 1))]
    return '<div class="wide"><table>' + "".join(f"<tr>{row}</tr>\n" for row in cells) + "</table></div>"
