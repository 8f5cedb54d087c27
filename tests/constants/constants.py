#!/usr/bin/env python3
"""What each tuned constant of fit and diagnosis decides: the forty rigs of discover_many and the real recordings that come
with the project are diagnosed with half and with twice its value, and a table tells what became of them.

A copy of the tree asks for its constants at run time, so that it is compiled once. CONSTANTS picks those whose file or
name contains one of its words, all without it. Writes docs/constants.md, keeping the rows of constants that were not
picked.
"""

import json
import math
import os
import re
import shutil
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

TREE = Path(__file__).resolve().parents[2]
BUILT = Path(os.environ.get("CARGO_TARGET_DIR", TREE / "target")) / "constants"
SOURCES = Path("host/identification/src")
TABLE = TREE / "docs/constants.md"
LOOKED_AT = ["diagnose", "fit", "verdict.rs"]

DEFINITION = re.compile(
    r"^(?P<head>pub(?:\([a-z]+\))? |)const (?P<name>[A-Z][A-Z0-9_]*): (?P<kind>f64|usize|u64) = (?P<value>[0-9._e-]+);$",
    re.MULTILINE,
)

# Numbers of books and places in lists: no other value makes sense.
NOT_TUNED = {
    "diagnose/formulas.rs:LINEAR",
    "diagnose/formulas.rs:POWER",
    "fit/clusters.rs:KIEFER_95",
    "fit/clusters.rs:NORMAL_95",
    "fit/tests.rs:RELEASE_RAD",
    "fit/uncertainty.rs:PROFILE_95",
}

# What lies before is no free swing.
BEGINS_S = {"dynamicslab_single_arm": "14.2"}

# What a constant becomes: a function that looks once whether another value was asked for.
FUNCTION = """#[allow(non_snake_case)]
{head}fn {name}() -> {kind} {{
    static VALUE: std::sync::OnceLock<{kind}> = std::sync::OnceLock::new();
    *VALUE.get_or_init(|| crate::tuned("{place}", "{value}").parse().unwrap())
}}"""

LOOK_UP = """
/// The value of a constant, or another one that was asked for; notes that it was needed.
pub fn tuned(place: &str, usual: &str) -> String {
    eprintln!("needed {place}");
    match std::env::var("TUNED").ok().and_then(|it| it.split_once('=').map(|(a, b)| (a.to_owned(), b.to_owned()))) {
        Some((wanted, value)) if wanted == place => value,
        _ => usual.to_owned(),
    }
}
"""


@dataclass
class Constant:
    """A number of the code: where it stands and its value as it is written there."""

    place: str
    kind: str
    value: str

    def changed(self, factor):
        """Its value times a factor; whole numbers are rounded up."""
        number = float(self.value.replace("_", "")) * factor
        return repr(number) if self.kind == "f64" else str(max(1, int(number + 0.5)))


@dataclass
class Rigs:
    """What became of forty rigs."""

    told: dict
    counts: list
    million_steps: int

    def cells(self):
        return [*self.counts, str(self.million_steps)]


@dataclass
class Recordings:
    """What became of the real recordings: verdict, error left and effort of each."""

    told: dict
    left: dict
    million_steps: int

    def cells(self, usual):
        """The error in the geometric mean beside the usual one, the largest change, and the effort."""
        changes = {name: math.log(left / usual.left[name]) for name, left in self.left.items()}
        mean = sum(changes.values()) / len(changes)
        return [percent(mean), percent(max(changes.values(), key=abs)), str(self.million_steps)]


@dataclass
class Judged:
    """What a value of a constant leads to."""

    rigs: Rigs
    recordings: Recordings
    needed: set

    def row(self, place, value, usual):
        rigs, recordings = self.rigs, self.recordings
        others = [name for name, told in rigs.told.items() if told != usual.rigs.told[name]]
        others += [name for name, told in recordings.told.items() if told != usual.recordings.told[name]]
        cells = [*rigs.cells(), *recordings.cells(usual.recordings), ", ".join(f"`{it}`" for it in others) or "none"]
        return "| " + " | ".join([f"`{place}`", value, *cells]) + " |"


def percent(logarithm):
    return f"{100 * math.expm1(logarithm):+.1f} %"


def main():
    words = os.environ.get("CONSTANTS", "").split()
    tree = copied()
    constants = [constant for constant in made_tunable(tree) if not words or any(it in constant.place for it in words)]
    if not constants:
        sys.exit(f"no constant has one of {words} in its place; places are like diagnose/search.rs:BEAM")
    programs = compiled(tree)
    usual = judged(programs, "")
    rows = read_rows()
    rows["as they are"] = usual.row("as they are", "", usual)
    print(rows["as they are"], flush=True)
    for constant in constants:
        rows = {label: line for label, line in rows.items() if not label.startswith(f"{constant.place} ")}
        if constant.place in usual.needed:
            values = [value for value in map(constant.changed, (0.5, 2.0)) if value != constant.value]
            with ThreadPoolExecutor() as pool:
                found = list(pool.map(lambda value: judged(programs, f"{constant.place}={value}"), values))
            for value, result in zip(values, found):
                told = result.row(constant.place, f"{value} for {constant.value}", usual)
                rows[f"{constant.place} {value}"] = told
                print(told, flush=True)
        write_rows(rows, usual=rows["as they are"])


def copied():
    """A copy of the files that are under version control, as they are now."""
    tree = BUILT / "tree"
    shutil.rmtree(tree, ignore_errors=True)
    listed = subprocess.run(["git", "ls-files", "-z"], cwd=TREE, check=True, capture_output=True, text=True).stdout
    for name in filter(None, listed.split("\0")):
        if (TREE / name).is_file():
            (tree / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(TREE / name, tree / name)
    return tree


def made_tunable(tree):
    """Turns the constants of a copy into functions; gives them."""
    root, found, public = tree / SOURCES, [], []
    files = sorted(file for part in LOOKED_AT for file in [*(root / part).rglob("*.rs"), root / part] if file.is_file())
    for file in files:
        text = file.read_text()
        for match in list(DEFINITION.finditer(text)):
            place = f"{file.relative_to(root)}:{match['name']}"
            if place in NOT_TUNED or must_be_constant(match, file, root):
                continue
            found.append(Constant(place, match["kind"], match["value"]))
            function = FUNCTION.format(place=place, **match.groupdict())
            text = called(text.replace(match[0], "\0"), match["name"]).replace("\0", function)
            if match["head"]:
                public.append(match["name"])
        file.write_text(text)
    users = [file for part in (SOURCES, "host/src", "tests") for file in (tree / part).rglob("*.rs")]
    for file in users:
        text = file.read_text()
        for name in public:
            if re.search(rf"^\s*(pub )?use [^;]*\b{name}\b", text, re.MULTILINE):
                text = called(text, name)
            text = re.sub(rf"^(?!\s*(?:pub )?use |\s*//)(.*::{name})\b(?!\()", r"\1()", text, flags=re.MULTILINE)
        file.write_text(text)
    library = root / "lib.rs"
    library.write_text(library.read_text() + LOOK_UP)
    return found


def must_be_constant(match, file, root):
    """Has the compiler to know it, as the length of an array or for another constant?"""
    name = match["name"]
    use = re.compile(rf"; {name}\]|, {name}>|const (?!{name}\b)[A-Z0-9_]+: [^=]*= [^;]*\b{name}\b")
    files = root.rglob("*.rs") if match["head"] else [file]
    return any(use.search(other.read_text()) for other in files)


def called(text, name):
    """Calls a name wherever it stands by itself, but for comments and imports."""
    lines, in_use = [], False
    for line in text.split("\n"):
        in_use = in_use or re.match(r"\s*(pub(\([a-z]+\))? )?use ", line) is not None
        if not in_use and not line.lstrip().startswith("//"):
            line = re.sub(rf"(?<![\w:]){name}\b(?!\()", f"{name}()", line)
        in_use = in_use and ";" not in line
        lines.append(line)
    return "\n".join(lines)


@dataclass
class Programs:
    """The test program of the forty rigs, the folder it wants to run in, and `host`."""

    forty: Path
    folder: Path
    host: Path


def compiled(tree):
    env = os.environ | {"CARGO_TARGET_DIR": str(BUILT)}
    parts = {"forty": ["test", "-p", "tests", "--test", "discover_many", "--no-run"], "host": ["build", "-p", "host"]}
    told = ""
    for part in parts.values():
        done = subprocess.run(["cargo", *part, "--locked"], cwd=tree, env=env, stderr=subprocess.PIPE, text=True)
        if done.returncode != 0:
            sys.exit(done.stderr)
        told += done.stderr
    forty = BUILT / re.search(r"\(.*?(debug/deps/discover_many-\w+)\)", told)[1]
    return Programs(forty=forty, folder=tree / "tests", host=BUILT / "debug/host")


def judged(programs, tuned):
    """Diagnoses the forty rigs and the real recordings with a constant changed, `place=value`, or as they are."""
    # One thread each: two values run side by side.
    env = os.environ | {"CARGO_MANIFEST_DIR": str(programs.folder), "RAYON_NUM_THREADS": "1", "TUNED": tuned}
    rigs, of_rigs = forty_rigs(programs, env)
    recordings, of_recordings = real_recordings(programs, env)
    return Judged(rigs, recordings, of_rigs | of_recordings)


def forty_rigs(programs, env):
    command = [programs.forty, "forty_rigs", "--nocapture"]
    done = subprocess.run(command, cwd=programs.folder, env=env, capture_output=True, text=True)
    lines = done.stdout.split("\n")
    marked = [line for line in lines if " million steps, " in line]
    if len(marked) < 37:
        sys.exit(f"{env['TUNED'] or 'as they are'}: the forty rigs came to no end\n{done.stderr[-2000:]}")
    told = {line[6:].split()[0]: line[:6] + line.split(" -> ")[1].split(", undecided")[0] for line in marked}
    shares = [line.split(": ")[1].split(",")[0] for line in lines if ", at least " in line]
    accused, exact = next(line for line in lines if line.startswith("accused ")).split("; exact ")
    million_steps = sum(int(line.split(" million steps, ")[0].split()[-1]) for line in marked)
    return Rigs(told, [exact, *shares, accused.removeprefix("accused ")], million_steps), needed(done)


def real_recordings(programs, env):
    folder = TREE / "host/data/recordings/real"
    rig = BUILT / "unknown.toml"
    subprocess.run([programs.host, "init", "--unknown-geometry", "--force", "-o", rig], check=True, capture_output=True)
    result, asked = Recordings({}, {}, 0), set()
    for file in sorted(folder.rglob("*.csv")):
        begin = ["--from", BEGINS_S[file.stem]] if file.stem in BEGINS_S else []
        command = [programs.host, "diagnose", file, "--rig", rig, "--json", *begin]
        done = subprocess.run(command, env=env, capture_output=True, text=True)
        asked |= needed(done)
        if done.returncode == 0:
            found = json.loads(done.stdout)
            result.told[file.stem] = found["verdict"]
            result.left[file.stem] = found["rmse_after"]
            result.million_steps += found["effort"]["million_steps"]
    return result, asked


def needed(done):
    return set(re.findall(r"^needed (\S+)", done.stderr, re.MULTILINE))


HEAD = """# What constants decide

The forty rigs of `tests/tests/discover_many.rs` and the real recordings of `host/data/recordings/real`, diagnosed with
half and with twice the value of a constant of `fit`, `diagnose` or `verdict.rs`; made by `tests/more constants`, which can
be given places: a row then stands beside the program of its own day, and the first row is that of the last run. Constants
that none of them asks for are not listed.

Of the rigs:

- **exact**: all that is hidden is named, and nothing else
- **first**: what is named first is hidden
- **pairs**: both of two are named
- **settled**: only noise is left, or more is said to be
- **accused**: rigs that lack nothing and are told to
- **steps**: millions of simulated steps that the diagnoses take together

Of the real recordings, of which nobody knows what they lack:

- **error**: what is left with what is claimed, in the geometric mean, beside the constant as it is
- **most**: the largest change of one of them
- **their steps**: as above

**Told otherwise**: rigs and recordings whose verdict is another one than with the constant as it is.
"""


def read_rows():
    """The rows of the table that stands, by constant and value."""
    lines = TABLE.read_text().split("\n") if TABLE.exists() else []
    cells = [(line, line.split("|")) for line in lines if line.startswith("| `")]
    return {f"{parts[1].strip(' `')} {parts[2].split(' for ')[0].strip()}": line for line, parts in cells}


def write_rows(rows, usual):
    names = ["constant", "value", "exact", "first", "pairs", "settled", "accused", "steps", "error", "most"]
    names += ["their steps", "told otherwise"]
    head = ["| " + " | ".join(names) + " |", "|" + "---|" * len(names)]
    others = [line for _, line in sorted(rows.items()) if line != usual]
    TABLE.write_text(HEAD + "\n" + "\n".join([*head, usual, *others]) + "\n")


if __name__ == "__main__":
    main()
