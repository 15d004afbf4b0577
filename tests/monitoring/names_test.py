#!/usr/bin/env python3
"""names_test.py SOURCE: the metrics of alerts and dashboards are those of docs/metrics.md, and each alert
has a test, and a section in docs/alerts.md, to which it links."""
import json
import os
import re
import sys

SUFFIX = re.compile(r"_(bucket|sum|count)$")
METRIC = re.compile(r"\b(?:graspdb|process)_[a-z_]+\b")


def read(*path):
    with open(os.path.join(sys.argv[1], *path), encoding="utf-8") as file:
        return file.read()


def main():
    documented = set(re.findall(r"^\| `([a-z_]+)` \|", read("docs", "metrics.md"), re.MULTILINE))
    alerts = read("monitoring", "alerts.yml")
    texts = {"alerts.yml": alerts, "alerts_test.yml": read("monitoring", "alerts_test.yml")}
    for name in ("server.json", "cell.json"):
        texts[name] = "\n".join(
            target["expr"]
            for panel in json.loads(read("monitoring", "dashboards", name))["panels"]
            for target in panel.get("targets", []))
    errors = []
    used = set()
    for name, text in texts.items():
        for metric in METRIC.findall(text):
            metric = metric if metric in documented else SUFFIX.sub("", metric)
            used.add(metric)
            if metric not in documented:
                errors.append(f"monitoring/{name} has {metric}, which docs/metrics.md does not list")
    if len(used) < 40:
        errors.append(f"only {len(used)} metrics were found")

    named = re.findall(r"- alert: (\w+)", alerts)
    sections = re.findall(r"^### (\w+)$", read("docs", "alerts.md"), re.MULTILINE)
    if named != sections:
        errors.append(f"docs/alerts.md and alerts.yml differ, or their order: {set(named) ^ set(sections)}")
    if re.findall(r"docs/alerts\.md#(\w+)", alerts) != [name.lower() for name in named]:
        errors.append("a runbook_url is not that of its alert")
    for name in named:
        if f"alertname: {name}" not in texts["alerts_test.yml"]:
            errors.append(f"alerts_test.yml has no test of {name}")
    print("\n".join(errors) or f"{len(used)} metrics, {len(named)} alerts")
    return 1 if errors else 0


if __name__ == "__main__":
    sys.exit(main())
