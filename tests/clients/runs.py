"""Runs of a program of Isoline in a temporary folder, for tests in Python."""

import json
import pathlib
import subprocess
import tempfile

CLIENTS = pathlib.Path(__file__).resolve().parents[2] / "clients"
SECONDS = 300


def process(*words):
    return f'process[command="{" ".join(map(str, words))}"]'


def run(isoline, problem, optimizer, *more):
    """What the program has printed, and the records by the label of the optimizer."""
    with tempfile.TemporaryDirectory() as folder:
        command = [isoline, "run", "--problem", problem, "--optimizer", optimizer, *more, "--out", "results"]
        ended = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=SECONDS)
        records = [json.loads(file.read_text()) for file in pathlib.Path(folder).glob("results/runs/*.json")]
    return ended.stdout + ended.stderr, {label(record): record for record in records}


def label(record):
    return record["foreign"]["optimizer"].get("label", "")
