"""Holds the language of the product's code: comments are sentences with a subject, in American spelling, and
private words for what the field has a term for do not come back."""
import pathlib
import re
import sys

ROOT = pathlib.Path(sys.argv[1])
FOLDERS = ["core", "slam", "mapping", "export", "server"]
# What a file or a service of ours has always been called stays: others read it.
KEPT = ['"centre"', '"knots"', '"height_normalised_rmse"']
RULES = [
    ("a comment begins with 'Of'", re.compile(r"//+<? Of ")),
    ("'likewise' says nothing", re.compile(r"\b[Ll]ikewise\b")),
    ("British spelling", re.compile(r"[Cc]olour|[Cc]entre|\b[Gg]rey\b|[Nn]eighbour|[a-z]metre|\b[Mm]etre|[Bb]ehaviour|"
                                    r"(?:[Oo]ptim|[Nn]ormal|[Ll]inear|[Mm]arginal|[Ii]nitial|[Mm]inim|[Rr]ecogn|"
                                    r"[Ss]ummar|[Ss]erial|[Ss]ynchron)is(?:e|ed|es|ing|ation)(?![a-z])")),
    ("a private word (docs/glossary.md)", re.compile(r"\b(?:[Kk]nots?|[Ss]ightings?|[Ll]ikeness|[Pp]hotos?)\b")),
]

files = [path for folder in FOLDERS for path in sorted((ROOT / folder).rglob("*")) if path.suffix in (".h", ".cpp")]
assert len(files) > 500, f"only {len(files)} files were found"
found = []
for path in files:
    for number, line in enumerate(path.read_text().splitlines(), 1):
        text = line
        for kept in KEPT:
            text = text.replace(kept, "")
        found += [f"{path.relative_to(ROOT)}:{number}: {name}: {line.strip()}" for name, rule in RULES if rule.search(text)]
print("\n".join(found) or f"{len(files)} files are in order")
sys.exit(1 if found else 0)
