#!/usr/bin/env python3
"""Makes programs keep the bounds that the IDL states for sequences.

    idl_bounds.py --staging FOLDER --output bounds.h [--generator 4] FILE.idl...

Changes the code of fastddsgen 2, FOLDER/FILE.cxx, or of fastddsgen 4, FOLDER/FILECdrAux.ipp, so that it reads no more
elements of a sequence than its bound (read_bounded.h), and writes a header for checks of received messages and of those to be sent:

    template <class Check> void visit_bounds(const LocalMap& message, Check& check);

calls check.schema(version) for a top-level message, check.size(field, size, bound) for each sequence,
check.value(field, value, last) for each enumeration and check.key(field, key, text) for each <text>_key after a string
<text> or <text>_id, with check.inside(field, body) around the calls for members. A file must come after those that it
includes, and a member must be on one line. Ends with 1 and a message for a member that it does not know.
"""
import argparse
import os
import re
import sys

PLAIN_TYPE = re.compile(r"(unsigned )?(short|long|long long)|octet|boolean|float|double|string<[0-9]+>")
SEQUENCE = re.compile(r"sequence<([A-Za-z0-9_ ]+), *([A-Za-z0-9_]+)> ([a-zA-Z0-9_]+)")
MEMBER = re.compile(r"([A-Za-z0-9_<> ]+) ([a-zA-Z0-9_]+)")
HEADER = """// Bounds of the messages, generated from the IDL by cmake/idl_bounds.py.
#pragma once

#include "types.h"

namespace topogeo::msg {{
{functions}
}}  // namespace topogeo::msg
"""


class BoundsError(Exception):
    """A member or code of fastddsgen that is not as expected."""


def blocks(text):
    """(kind, name, lines) of each struct and enum of an IDL file, without comments, keys and separators."""
    text = re.sub(r"//[^\n]*", "", text)
    text = re.sub(r"[;,] *\n", "\n", text)
    for kind, name, body in re.findall(r"(struct|enum) (\w+) {([^}]*)}", text):
        lines = (re.sub(r"^@key +", "", line.strip()) for line in body.split("\n"))
        yield kind, name, [line for line in lines if line]


def typedefs(text):
    return re.findall(r"typedef [a-z ]+ (\w+)", re.sub(r"//[^\n]*", "", text))


class Generator:
    """Where a version of fastddsgen writes the code that reads a struct, and how it names its members there."""

    def __init__(self, suffix, begin, member):
        self.suffix = suffix
        self._begin = begin
        self._member = member

    def bound_reading(self, source, struct, member, bound):
        """`source`, in which the code that reads a sequence of a struct keeps its bound."""
        begin = source.find(self._begin.format(struct=struct))
        if begin < 0:
            raise BoundsError(f"no code reads {struct}")
        expression = self._member.format(member=member)
        read = f"dcdr >> {expression};"
        at = source.find(read, begin)
        if at < 0 or at > source.find("\n}", begin):
            raise BoundsError(f"no code reads {member} of {struct}")
        return f"{source[:at]}topogeo::msg::read_bounded(dcdr, {expression}, {bound});{source[at + len(read):]}"


GENERATORS = {
    "2": Generator(".cxx", "void topogeo::msg::{struct}::deserialize(", "m_{member}"),
    "4": Generator("CdrAux.ipp", "\n        topogeo::msg::{struct}& data)", "data.{member}()")}


class Bounds:
    """The checks of all files so far."""

    def __init__(self, generator=GENERATORS["2"]):
        self.functions = ""
        self._generator = generator
        self._structs = set()
        self._visited = set()  # structs that have anything to check
        self._typedefs = set()
        self._last_of_enum = {}

    def add(self, name, text, source):
        """Adds the checks of an IDL file. Returns `source`, the code of fastddsgen for it, with bounded reading."""
        self._typedefs.update(typedefs(text))
        source = source.replace("#include <fastcdr/Cdr.h>\n", '#include <fastcdr/Cdr.h>\n\n#include "read_bounded.h"\n')
        for kind, struct, lines in blocks(text):
            if kind == "enum":
                self._last_of_enum[struct] = lines[-1]
                continue
            code = ""
            members = []
            for line in lines:
                try:
                    if found := SEQUENCE.fullmatch(line):
                        code += self._check_of_sequence(*found.groups())
                        source = self._generator.bound_reading(source, struct, found[3], f"topogeo::msg::{found[2]}")
                    elif found := MEMBER.fullmatch(line):
                        code += self._check_of_member(*found.groups(), members)
                        members.append(found[2])
                    else:
                        raise KeyError(line)
                except KeyError:
                    raise BoundsError(f"{name}: {struct}: expected a member 'type name' with a known type: "
                                      f"'{line}'") from None
            self._structs.add(struct)
            if code:
                self._visited.add(struct)
                self.functions += ("\ntemplate <class Check>\n"
                                   f"void visit_bounds(const {struct}& message, Check& check) {{\n{code}}}\n")
        return source

    def header(self):
        return HEADER.format(functions=self.functions)

    def _check_of_sequence(self, element, bound, member):
        code = f'  check.size("{member}", message.{member}().size(), {bound});\n'
        if element in self._visited:
            return code + (f'  check.inside("{member}", [&] {{\n'
                           f"    for (const {element}& entry : message.{member}()) visit_bounds(entry, check);\n  }});\n")
        if element not in self._structs and not PLAIN_TYPE.fullmatch(element):
            raise KeyError(element)
        return code

    def _check_of_member(self, type_name, member, members):
        """Raises KeyError for an unknown type, and for a key without its text among `members`, those before it."""
        if member == "schema_version":
            return "  check.schema(message.schema_version());\n"
        if member.endswith("_key"):
            text = member.removesuffix("_key")
            text = f"{text}_id" if f"{text}_id" in members else text
            if text not in members:
                raise KeyError(member)
            return f'  check.key("{member}", message.{member}(), message.{text}());\n'
        if type_name in self._last_of_enum:
            return f'  check.value("{member}", message.{member}(), {self._last_of_enum[type_name]});\n'
        if type_name in self._visited:
            return f'  check.inside("{member}", [&] {{ visit_bounds(message.{member}(), check); }});\n'
        if type_name in self._structs | self._typedefs or PLAIN_TYPE.fullmatch(type_name):
            return ""
        raise KeyError(type_name)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("--staging", required=True)
    parser.add_argument("--output", required=True)
    parser.add_argument("--generator", choices=GENERATORS, default="2", help="version of fastddsgen")
    parser.add_argument("files", nargs="+", metavar="FILE")
    options = parser.parse_args()
    generator = GENERATORS[options.generator]
    bounds = Bounds(generator)
    try:
        for name in options.files:
            stem = os.path.splitext(os.path.basename(name))[0]
            generated = os.path.join(options.staging, stem + generator.suffix)
            with open(name, encoding="utf-8") as idl, open(generated, encoding="utf-8") as code:
                source = bounds.add(name, idl.read(), code.read())
            with open(generated, "w", encoding="utf-8") as code:
                code.write(source)
    except BoundsError as error:
        sys.exit(f"idl_bounds.py: {error}")
    with open(options.output, "w", encoding="utf-8") as header:
        header.write(bounds.header())


if __name__ == "__main__":
    main()
