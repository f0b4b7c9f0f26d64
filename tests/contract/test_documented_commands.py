"""Contract: every command and block of code in the documents is one that the programs take.

The code of docs/python.md, all but its first lines, is run on the sample's results by tests/workflow/test_quick.py.
"""

from __future__ import annotations

import argparse
import ast
import importlib.util
import inspect
import re
import shlex
from pathlib import Path

import pytest
import yaml
from snakemake.cli import parse_args

import threedfs
from threedfs.cli.main import _make_parser
from threedfs.params.configuration import check_configuration, configuration_schema
from threedfs.params.schema import find_params, make_params

ROOT = Path(__file__).resolve().parents[2]
DOCUMENTS = [ROOT / name for name in ("README.md", "CONTRIBUTING.md", "config/README.md")]
DOCUMENTS += sorted((ROOT / "docs").glob("*.md"))
PROGRAMS = ("threedfs", "snakemake", "make", "python")
SHELL = ("git", "cd", ".", "mkdir")
LOOK = re.compile(r"`(?:\.venv/bin/)?threedfs ([a-z]+[^`]*)`")


def find_blocks(text):
    """Return the indented blocks of a document."""
    blocks = re.findall(r"(?:^|\n)\n((?:    [^\n]*\n)+)", text.replace("\n\n", "\n\n\n"))
    return [re.sub(r"^    ", "", block, flags=re.MULTILINE) for block in blocks]


def find_commands(block):
    """Return the commands of a block as lists of words; a quoted word may run over lines."""
    commands, pending = [], ""
    for line in block.splitlines():
        pending += line + "\n"
        try:
            words = shlex.split(pending, comments=True)
        except ValueError:  # no closing quotation yet
            continue
        pending = ""
        for part in " ".join(map(shlex.quote, words)).split(" '&&' "):
            commands.append(shlex.split(part))
    return [words for words in commands if words]


def is_shell(block):
    return name_program(block.split(maxsplit=1)[0]) in (*PROGRAMS, *SHELL)


def name_program(word):
    return word if word in SHELL else Path(word).name  # "." has no name


COMMANDS = [
    pytest.param(words, id=f"{path.name}: {' '.join(words)[:60]}")
    for path in DOCUMENTS
    for block in find_blocks(path.read_text())
    if is_shell(block)
    for words in find_commands(block)
]
MENTIONED = [
    pytest.param(text, id=f"{path.name}: {text}") for path in DOCUMENTS for text in LOOK.findall(path.read_text())
]


def subcommands(parser):
    (found,) = (action for action in parser._actions if isinstance(action, argparse._SubParsersAction))
    return found.choices


def test_there_are_commands():
    programs = {Path(param.values[0][0]).name for param in COMMANDS}
    assert programs >= set(PROGRAMS) and len(COMMANDS) > 30 and len(MENTIONED) > 10


@pytest.mark.parametrize("words", COMMANDS)
def test_a_command_is_taken(words):
    program, arguments = name_program(words[0]), words[1:]
    if program == "threedfs":
        _make_parser().parse_args(arguments)
    elif program == "snakemake":
        check_snakemake(arguments)
    elif program == "make":
        targets = re.findall(r"^([\w-]+):", (ROOT / "Makefile").read_text(), re.MULTILINE)
        assert set(arguments) <= set(targets)
    elif program == "python" and arguments[0] == "-m":
        assert importlib.util.find_spec(arguments[1]) is not None
    elif program == "python":
        assert (ROOT / arguments[0]).is_file()
    else:
        assert program in SHELL


def check_snakemake(arguments):
    """Parse the options; files of the project are there, and keys of the configuration are known."""
    if "--profile" in arguments:  # its executor may not be installed
        place = arguments.index("--profile")
        assert (ROOT / arguments[place + 1].removeprefix("../")).is_dir()
        arguments = arguments[:place] + arguments[place + 2 :] + ["--cores", "1"]
    parsed = parse_args(arguments)[1]
    for file in map(str, parsed.configfile or []):
        assert Path(file).name.startswith(("my", "part", "two_")) or (ROOT / file).is_file()
    for pair in parsed.config or []:
        key, _, value = pair.partition("=")
        properties = configuration_schema()["properties"]
        assert key in properties
        if key == "methods":
            assert set(yaml.safe_load(value)) <= set(properties["methods"]["items"]["enum"])


@pytest.mark.parametrize("text", MENTIONED)
def test_a_command_in_a_sentence_has_its_options(text):
    words, parser = text.split(), _make_parser()
    while words and not words[0].startswith("-"):
        try:
            choices = subcommands(parser)
        except ValueError:
            break
        assert words[0] in choices
        parser = choices[words.pop(0)]
    options = {option for action in parser._actions for option in action.option_strings}
    assert {word for word in words if word.startswith("--")} <= options


def test_the_call_from_python_is_taken():
    (block,) = (each for each in find_blocks((ROOT / "docs/python.md").read_text()) if each.startswith("import"))
    (call,) = (node for node in ast.walk(ast.parse(block)) if isinstance(node, ast.Call))
    assert ast.unparse(call.func) == "threedfs.reconstruct"
    given = {word.arg: ast.literal_eval(word.value) for word in call.keywords}
    inspect.signature(threedfs.reconstruct).bind(*map(ast.literal_eval, call.args), **given)
    for stage, settings in given["settings"].items():
        make_params(find_params(stage), {**vars(find_params(stage)()), **settings})


def test_a_configuration_in_the_documents_is_one():
    blocks = [block for path in DOCUMENTS for block in find_blocks(path.read_text()) if "sequences:\n" in block]
    assert blocks
    defaults = yaml.safe_load((ROOT / "config/config.yaml").read_text())
    for block in blocks:
        check_configuration({**defaults, **yaml.safe_load(block)}, configuration_schema())
