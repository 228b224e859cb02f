"""Divides the sources of targets into units of several files, so that no unit defines a name twice in anonymous
namespaces: `unity_groups.py FILE CACHE` reads lines `target<TAB>largest<TAB>source` from FILE, where a unit has at most
`largest` files (0: no limit), and prints `target<TAB>unit<TAB>source`. CACHE keeps the names of unchanged files.
"""
import json
import os
import re
import sys

KEYWORDS = {"alignas", "const", "constexpr", "consteval", "constinit", "decltype", "explicit", "extern", "if", "inline",
            "namespace", "noexcept", "operator", "requires", "return", "sizeof", "static", "static_assert", "template",
            "typename", "using", "virtual", "void", "volatile", "while"}
MOST_ARGUMENTS = 99  # of a function with a parameter pack
# Comments, raw strings, strings and characters; a digit separator is no character.
NO_CODE = re.compile(r'//[^\n]*|/\*.*?\*/|R"([^\s()\\]*)\(.*?\)\1"|"(?:\\.|[^"\\\n])*"|(?<![0-9a-fA-F])\'(?:\\.|[^\'\\\n])+\'',
                     re.DOTALL)
TOKEN = re.compile(r"[A-Za-z_]\w*|\d[\w.']*|::|\[\[|\]\]|[^\s\w]")


def without(tokens, opening, closing):
    """The tokens outside of these brackets."""
    depth, kept = 0, []
    for token in tokens:
        depth += (token == opening) - (token == closing)
        if depth == 0 and token != closing:
            kept.append(token)
    return kept


def declared(tokens):
    """(name, detail) that a declaration at namespace scope introduces, None for one without a name of its own. The
    detail is "(least,most)" of a function that takes so many arguments, "=type" of an alias, "" of anything else."""
    while tokens[:1] == ["template"]:
        depth, end = 0, 1
        for end in range(1, len(tokens)):
            depth += {"<": 1, ">": -1}.get(tokens[end], 0)
            if depth == 0:
                break
        tokens = tokens[end + 1:]
    tokens = without(tokens, "[[", "]]")
    if not tokens or tokens[0] in ("static_assert", "namespace", "friend"):
        return None
    if tokens[0] == "using":
        return (tokens[1], "".join(tokens[2:])) if tokens[2:3] == ["="] else None
    if tokens[0] in ("struct", "class", "enum", "union"):
        names = [token for token in tokens[1:] if token not in ("class", "struct")]
        return (names[0], "") if names else None
    depth, name, before = 0, None, ""
    for i, token in enumerate(tokens):
        if token == "<" and re.match(r"[A-Za-z_]", before):
            depth += 1
        elif token == ">" and depth > 0:
            depth -= 1
        elif depth == 0 and token == "operator":
            return None
        elif depth == 0 and token in ("(", "=", "["):
            if name and token == "(" and not re.fullmatch("[A-Z][A-Z0-9_]+", name):  # which would be a macro
                return name, counts_of_arguments(tokens[i:])
            return (name, "") if name and token != "(" else None
        elif depth == 0 and re.match(r"[A-Za-z_]", token) and token not in KEYWORDS:
            name = None if before == "::" else token  # a member of a class, or the rest of the name of a type
        before = token
    return (name, "") if name else None


def counts_of_arguments(tokens):
    """"(1,2)", the least and most arguments that a function takes, of the tokens "( int a , double b = 1 ) const"."""
    depth, parameters = 0, [[]]
    for token in tokens:
        depth += (token in "(<[{") - (token in ")>]}")
        if depth == 0:
            break
        if token == "," and depth == 1:
            parameters.append([])
        elif token != "(" or depth > 1:
            parameters[-1].append(token)
    if parameters in ([[]], [["void"]]):
        return "(0,0)"
    packs = sum("." in parameter for parameter in parameters)  # "..." is three tokens
    least = sum("=" not in parameter and "." not in parameter for parameter in parameters)
    return f"({least},{MOST_ARGUMENTS if packs else len(parameters)})"


def names_in(text):
    """(namespace, name, detail) of each declaration in an anonymous namespace, and of each static one."""
    found = set()
    scopes = []  # name of a namespace, "" if anonymous; None of any other brace
    start = []  # tokens of the declaration so far
    parentheses = 0
    for token in TOKEN.findall(NO_CODE.sub(" ", re.sub(r"^\s*#.*(?:\\\n.*)*$", "", text, flags=re.MULTILINE))):
        at_namespace = None not in scopes
        if token in "()":
            parentheses += 1 if token == "(" else -1
        if token == "{" and parentheses == 0:
            if at_namespace and "namespace" in start[:2] and "=" not in start:
                scopes.append("".join(t for t in start if t not in ("namespace", "inline")))
            else:
                if at_namespace:
                    note(found, scopes, start)
                scopes.append(None)
            start = [] if None not in scopes else ["{"]
        elif token == "}" and parentheses == 0:
            if scopes:
                scopes.pop()
            if None not in scopes:
                start = []
        elif token == ";" and parentheses == 0:
            if at_namespace and start:
                note(found, scopes, start)
            if at_namespace:
                start = []
        elif at_namespace:
            start.append(token)
    return sorted(found)


def note(found, scopes, tokens):
    # Other tokens are the end of an expression with braces.
    if tokens and re.match(r"[A-Za-z_:]|\[\[", tokens[0]) and ("" in scopes or tokens[0] == "static"):
        name = declared(tokens)
        if name and name[0] not in KEYWORDS:
            found.add(("::".join(scope for scope in scopes if scope), *name))


def clash(own, others):
    """Whether one unit cannot have both sets of details of a name. Two functions are apart only by the number of their
    arguments: a conversion could let a call meant for one choose the other, or neither."""
    for mine in own:
        for other in others:
            if mine.startswith("(") and other.startswith("("):
                (least, most), (other_least, other_most) = (map(int, x[1:-1].split(",")) for x in (mine, other))
                if least <= other_most and other_least <= most:
                    return True
            elif not mine.startswith("=") or mine != other:
                return True
    return False


def divided(sources, names, largest):
    """Number of the unit of each source, in order: the first with room where no name clashes."""
    units = []  # (number of files, details by name)
    numbers = []
    for source in sources:
        own = {}
        for scope, name, detail in names[source]:
            own.setdefault((scope, name), set()).add(detail)
        for number, (count, others) in enumerate(units):
            if (largest == 0 or count < largest) and not any(clash(own[n], others[n]) for n in own.keys() & others):
                break
        else:
            number = len(units)
            units.append([0, {}])
        units[number][0] += 1
        for name, details in own.items():
            units[number][1].setdefault(name, set()).update(details)
        numbers.append(number)
    return numbers


def read_names(sources, cache_file):
    """The names of each source; those of files that have not changed come from the cache."""
    try:
        with open(cache_file, encoding="utf-8") as file:
            cache = json.load(file)
    except (OSError, ValueError):
        cache = {}
    fresh = {}
    own_time = os.stat(__file__).st_mtime_ns
    for source in filter(os.path.exists, sources):  # the build may make others later
        times = [os.stat(source).st_mtime_ns, own_time]
        entry = cache.get(source)
        if not entry or entry["times"] != times:
            with open(source, encoding="utf-8") as file:
                entry = {"times": times, "names": names_in(file.read())}
        fresh[source] = entry
    if fresh != cache:
        with open(cache_file, "w", encoding="utf-8") as file:
            json.dump(fresh, file)
    return {source: fresh[source]["names"] if source in fresh else [] for source in sources}


def main():
    targets = {}
    with open(sys.argv[1], encoding="utf-8") as file:
        for line in file:
            target, largest, source = line.rstrip("\n").split("\t")
            targets.setdefault((target, int(largest)), []).append(source)
    names = read_names(sorted({source for sources in targets.values() for source in sources}), sys.argv[2])
    for (target, largest), sources in targets.items():
        for source, unit in zip(sources, divided(sources, names, largest)):
            print(f"{target}\t{unit}\t{source}")


if __name__ == "__main__":
    main()
