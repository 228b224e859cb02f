"""Durations of tests, by which ctest orders them: tests/costs.txt, which CMake reads."""

HEADER = """# Duration of each test: seconds, name. The longest start first, so that none runs alone at the end. A test with a
# lock counts with all that wait for the same lock. A test that is missing here takes less than a second or is new:
# ctest orders it by its own measurements. `./run test --save-costs` writes this file.
"""


def locks_of(listing):
    """Locks of each test in what `ctest --show-only=json-v1` prints."""
    locks = {}
    for test in listing["tests"]:
        for entry in test["properties"]:
            if entry["name"] == "RESOURCE_LOCK":
                locks[test["name"]] = entry["value"]
    return locks


def fixed_of(listing, table):
    """Tests whose CMakeLists gives a cost: those that have one without being in the table."""
    return {test["name"] for test in listing["tests"]
            if test["name"] not in table and any(entry["name"] == "COST" for entry in test["properties"])}


def read_costs(path):
    costs = {}
    try:
        with open(path, encoding="utf-8") as file:
            for line in file:
                if line[:1].isdigit():
                    seconds, name = line.rstrip("\n").split(" ", 1)
                    costs[name] = int(seconds)
    except FileNotFoundError:
        pass
    return costs


def costs_of(seconds, locks):
    """The cost of each test: its seconds, and those of the shorter ones that wait for the same lock."""
    costs = dict(seconds)
    for lock in {lock for held in locks.values() for lock in held}:
        total = 0.0
        for name in sorted((name for name in seconds if lock in locks.get(name, ())), key=seconds.get):
            total += seconds[name]
            costs[name] = max(costs[name], total)
    return costs


def save_costs(path, tests, listing):
    """Those of the tests that have run and passed; of others what the file said."""
    table = read_costs(path)
    fixed = fixed_of(listing, table)
    there = {test["name"] for test in listing["tests"]}
    measured = costs_of({test.name: test.seconds for test in tests if test.state == "passed"}, locks_of(listing))
    table = {name: cost for name, cost in table.items() if name in there and name not in measured}
    table.update((name, round(cost)) for name, cost in measured.items() if name not in fixed and cost >= 1.0)
    with open(path, "w", encoding="utf-8") as file:
        file.write(HEADER)
        for name, cost in sorted(table.items(), key=lambda entry: (-entry[1], entry[0])):
            file.write(f"{cost} {name}\n")
    return len(table)
