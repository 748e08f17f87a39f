#!/usr/bin/env python3
"""Comments of the product are sentences, in the field's terms and American spelling.

usage: comments_test.py SOURCE_DIR [FOLDER ...]

Refuses, in the sources of the product (or of the folders that are named):
  * a comment that begins with "Of ": it has no subject;
  * "likewise", which names nothing;
  * British spellings, in comments, texts and names;
  * terms of our own for what the field has a word for (docs/glossary.md).
"""

import re
import sys
from pathlib import Path

FOLDERS = ["core", "slam", "mapping", "export", "server"]
SUFFIXES = {".h", ".cpp", ".json"}

# Keys of files that others read.
EXCEPTIONS = re.compile(r'"centre"|height_normalised_rmse|"(?:num_)?knots"|lines? of sight')

VERBS = """analy categor character discret equal factor final general initial linear local
marginal maxim minim modern neutral normal optim organ parameter parametr penal polar quant random
raster real recogn regular serial special stabil standard summar synchron util vector visual""".split()
BRITISH = re.compile(
    r"(?<![a-z])(?:colour\w*|(?:kilo|centi|milli)?metres?|centre[sd]?|centring|grey\w*|neighbour\w*"
    r"|behaviour\w*|favour\w*|labell\w+|travell\w+|modell\w+|levell\w+|catalogue\w*"
    rf"|(?:re|un|de)?(?:{'|'.join(VERBS)})(?:is|ys)(?:e|es|ed|ing|er|ers|ation|ations|able))(?![a-z])")
PRIVATE = re.compile(r"(?<![a-z])(?:likewise|knots?|photos?|sightings?|sights?|likeness(?:es)?|likest)(?![a-z])")

COMMENT = re.compile(r'"(?:\\.|[^"\\\n])*"|(?P<comment>//[^\n]*)')
OF = re.compile(r"//[/!]?<?\s*Of\s")


def words(line):
    """The line in lower case, names of several words apart: `LinearisedBlock` has two."""
    return re.sub(r"(?<=[a-z0-9])(?=[A-Z])", " ", line).replace("_", " ").lower()


def faults(text):
    """(number of the line, what is wrong) of a source."""
    before = None  # column of the comment in the line before, which one at the same column goes on
    for number, line in enumerate(text.splitlines(), 1):
        comment = next((m for m in COMMENT.finditer(line) if m["comment"]), None)
        column = comment.start() if comment else None
        if comment and column != before and OF.match(comment["comment"]):
            yield number, 'a comment begins with "Of": give it a subject'
        before = column
        line = words(EXCEPTIONS.sub("", line))
        for match in BRITISH.finditer(line):
            yield number, f'"{match[0]}" is British spelling'
        for match in PRIVATE.finditer(line):
            yield number, f'"{match[0]}" is no term of the field'


def check_itself():
    """The check finds what it is for, and nothing else."""
    bad = ["/// Of the pose.", "f();  // a part\n// Of it", "int a;  // Of a line", "// [m] likewise",
           "Normalised()", "kGreyLevel", "// two metres", "knot_count", "// a sight of it", '"colour"']
    good = ["/// The norm\n/// Of which", "f();  // a part\n      // Of it", "// a line of sight",
            'Read("centre")', "// otherwise raised", "// cancelled", "promise = rise;",
            "// insight, noise", 'Print("// Of it");']
    for source in bad:
        assert list(faults(source)), f"missed: {source}"
    for source in good:
        assert not list(faults(source)), f"refused: {source}"


def main():
    check_itself()
    root = Path(sys.argv[1])
    files = [file for folder in sys.argv[2:] or FOLDERS for file in sorted((root / folder).rglob("*"))
             if file.suffix in SUFFIXES]
    if len(files) < 10 and not sys.argv[2:]:
        sys.exit(f"only {len(files)} sources below {root}")
    count = 0
    for file in files:
        name = file.relative_to(root).as_posix()
        for number, fault in faults(file.read_text(encoding="utf-8")):
            print(f"{name}:{number}: {fault}")
            count += 1
    if count:
        sys.exit(f"{count} faults in {len(files)} sources")
    print(f"{len(files)} sources")


main()
