#!/usr/bin/env python3
"""Gives the code of fastddsgen 4 the names and values that fastddsgen 2 gives its own.

    fastddsgen4.py prepare --staging FOLDER FILE.idl...   before fastddsgen
    fastddsgen4.py finish --staging FOLDER FILE.idl...    after it

`prepare` copies the files to the folder with numbers in place of the constants that bound sequences and arrays, because
fastddsgen 4.0.4 writes no size for a type with such a bound ("constexpr uint32_t x {UL}") and takes it for one without
a key. Files must come after those that they include. `finish` makes the enumerations plain ones of type uint32_t, and
leaves out a log message for each type without a description of itself. Ends with 1 and a message for an unknown bound.
"""
import argparse
import os
import re
import sys

CONSTANT = re.compile(r"const\s+[a-z ]+\s(\w+)\s*=\s*(\d+)\s*;")
COMMENT = re.compile(r"//[^\n]*")
BOUND = re.compile(r"(sequence<[^<>,]+,\s*|\[\s*)([A-Za-z_]\w*)(\s*[>\]])")
WARNING = re.compile(r"EPROSIMA_LOG_WARNING\(XTYPES_TYPE_REPRESENTATION,\s*\"[^\"]*\"\);")


class UnknownBound(Exception):
    """A bound that is no constant of the files so far."""


def with_numbers(name, text, constants):
    """The IDL without comments and with numbers as bounds. Adds its constants to `constants`."""
    text = COMMENT.sub("", text)
    constants.update(CONSTANT.findall(text))

    def number(found):
        if found[2] not in constants:
            raise UnknownBound(f"{name}: the bound '{found[2]}' is no constant")
        return found[1] + constants[found[2]] + found[3]

    return BOUND.sub(number, text)


def with_plain_enumerations(header):
    return re.sub(r"\benum class (\w+) : int32_t\b", r"enum \1 : uint32_t", header)


def without_warnings(code):
    return WARNING.sub("", code)


def rewrite(path, change):
    with open(path, encoding="utf-8") as file:
        text = change(file.read())
    with open(path, "w", encoding="utf-8") as file:
        file.write(text)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("step", choices=["prepare", "finish"])
    parser.add_argument("--staging", required=True)
    parser.add_argument("files", nargs="+", metavar="FILE")
    options = parser.parse_args()
    constants = {}
    for name in options.files:
        staged = os.path.join(options.staging, os.path.basename(name))
        stem = os.path.splitext(staged)[0]
        if options.step == "prepare":
            try:
                with open(name, encoding="utf-8") as idl:
                    text = with_numbers(name, idl.read(), constants)
            except UnknownBound as error:
                sys.exit(f"fastddsgen4.py: {error}")
            with open(staged, "w", encoding="utf-8") as idl:
                idl.write(text)
        else:
            rewrite(stem + ".hpp", with_plain_enumerations)
            rewrite(stem + "PubSubTypes.cxx", without_warnings)


if __name__ == "__main__":
    main()
