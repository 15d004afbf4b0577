#!/usr/bin/env python3
"""lines.py: a Markdown table of the source files and lines of each folder that docs/architecture.md lists, and of tests.

Counts tracked C++, proto, Python and shell files; a folder's row leaves out the rows of its subfolders.
"""
import re
import subprocess

SOURCE = re.compile(r"\.(cc|h|proto|py|sh)$|/graspdb-[a-z-]+$|^run$")


def main():
    with open("docs/architecture.md", encoding="utf-8") as file:
        folders = re.findall(r"^\| `([a-z_/]+)` \|", file.read(), re.MULTILINE) + ["proto", "examples", "tests"]
    files = subprocess.run(["git", "ls-files"], capture_output=True, text=True, check=True).stdout.split()
    rows = {folder: [] for folder in folders}
    for path in filter(SOURCE.search, files):
        inside = [folder for folder in folders if path.startswith(folder + "/")]
        if inside:
            with open(path, "rb") as file:
                rows[max(inside, key=len)].append((file.read().count(b"\n"), path))
    print("| folder | files | lines | longest file |\n| --- | ---: | ---: | --- |")
    for folder, lines in rows.items():
        count, longest = max(lines)
        print(f"| `{folder}` | {len(lines)} | {sum(n for n, _ in lines):,} | `{longest.rsplit('/', 1)[1]}`, {count} |")
    product = [n for folder, lines in rows.items() if folder not in ("tests", "examples") for n, _ in lines]
    print(f"| all but tests and examples | {len(product)} | {sum(product):,} | |")


main()
