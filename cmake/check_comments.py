"""Finds sentences of comments and pages that begin with a word that hangs in the air, and lines of pages that are too
long: `check_comments.py FILE...` prints `file:line: fault`, and ends with 1 if there is any."""
import re
import sys

# A sentence has its subject first: "Of the points those in sight" has to be read twice.
HANGING = {"Of", "By", "To", "As", "From", "Those", "What", "Who", "Whoever", "Whose"}
LONGEST = 120  # columns of a line of a page

# Comment markers by file ending.
MARKS = {
    ".cpp": r"///?<?", ".hpp": r"///?<?", ".ts": r"//|/\*\*|\*", ".mjs": r"//|/\*\*|\*", ".idl": r"//", ".proto": r"//",
    ".py": r"#", ".sh": r"#", ".cmake": r"#", ".txt": r"#", ".yaml": r"#", "": r"#",
}


def comment_blocks(lines, mark):
    """Lists of (number of the line, text): comments of consecutive lines, and each that follows code."""
    whole = re.compile(rf"^\s*(?:{mark})(?:\s(.*)|)$")
    after_code = re.compile(rf"^.*[\s;,{{}}(](?:{mark})\s(.*)$")
    block = []
    for number, line in enumerate(lines, 1):
        if found := whole.match(line):
            text = (found.group(1) or "").strip()
            if text:
                block.append((number, text))
                continue
        elif (found := after_code.match(line)) and '"' not in line:
            if block:
                yield block
            # Comment lines below continue it.
            block = [(number, found.group(1).strip())]
            continue
        if block:
            yield block
        block = []
    if block:
        yield block


def page_blocks(lines):
    """The same of the paragraphs and items of a page; without code, tables and headings."""
    block, fenced = [], False
    for number, line in enumerate(lines, 1):
        if line.startswith("```"):
            fenced = not fenced
        text = line.strip()
        item = re.match(r"^(?:[-*]|\d+\.)\s+(.*)$", text)
        plain = not fenced and text and not line.startswith("    ") and text[0] not in "|#<`!"
        if (item or not plain) and block:
            yield block
            block = []
        if not fenced and item:
            block = [(number, item.group(1))]
        elif plain or (block and text):
            block.append((number, text))
    if block:
        yield block


def hanging(block):
    """(line, word) of each sentence of a block that begins with a hanging word."""
    ended = True
    for number, text in block:
        words = text.split()
        for i, word in enumerate(words):
            bare = word.strip("*_(\"'")
            if ended and bare.rstrip(",:") in HANGING:
                yield number, bare
            ended = re.search(r"[.!?][)*_\"'`]*$", word) is not None and not re.match(
                r"^(?:e\.g|i\.e|cf|vs|p|pp|ch|Eq|eq|Sec|Fig|Tab|al|No|[A-Z])\.$", word)


def faults(path):
    with open(path, encoding="utf-8", errors="replace") as file:
        lines = file.read().split("\n")
    ending = re.search(r"(\.[a-z]+)?$", path.rsplit("/", 1)[-1]).group(0)
    if ending == ".md":
        blocks = page_blocks(lines)
        fenced = False
        for number, line in enumerate(lines, 1):
            if line.startswith("```"):
                fenced = not fenced
            prose = not fenced and not line.startswith(("|", "    ", "#", "!"))
            if prose and len(line) > LONGEST and "http" not in line:
                yield number, f"{len(line)} columns, the limit is {LONGEST}"
    elif ending in MARKS:
        blocks = comment_blocks(lines, MARKS[ending])
    else:
        return
    for block in blocks:
        for number, word in hanging(block):
            yield number, f'a sentence begins with "{word}"'


def main():
    found = False
    for path in sys.argv[1:]:
        for number, fault in faults(path):
            found = True
            print(f"{path}:{number}: {fault}")
    sys.exit(1 if found else 0)


if __name__ == "__main__":
    main()
