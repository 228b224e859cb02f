"""What each test costs, by which ctest orders them and runs them in parallel: tests/costs.txt, which CMake reads."""

HEADER = """# Cost of each test: seconds, cores, name. The longest start first, so that none runs alone at the end. A test with a
# lock counts with all that wait for the same lock. Cores are the mean that a test would keep busy: many tests mostly
# wait, and more of these run at once. A test that is missing here takes less than a second or is new: ctest orders it
# by its own measurements. `./run test --save-costs` writes this file.
"""

# Processes in containers belong to the engine: tests that start them are taken to keep at least so many cores busy.
CORES_WITH_CONTAINERS = 0.8
WITH_CONTAINERS = ("container.", "package.", "security.")


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
    """{name: (seconds, cores)}."""
    costs = {}
    try:
        with open(path, encoding="utf-8") as file:
            for line in file:
                if line[:1].isdigit():
                    seconds, cores, name = line.rstrip("\n").split(" ", 2)
                    costs[name] = (int(seconds), float(cores))
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


def cores_of(name, seconds, cpu_seconds):
    """Mean number of cores that a test would keep busy, in tenths, at least one tenth."""
    cores = cpu_seconds.get(name, 0.0) / seconds
    return max(round(cores, 1), CORES_WITH_CONTAINERS if name.startswith(WITH_CONTAINERS) else 0.1)


def save_costs(path, tests, listing, cpu_seconds):
    """Writes costs of the tests that have run and passed; keeps those of others. cpu_seconds: what each wanted."""
    table = read_costs(path)
    fixed = fixed_of(listing, table)
    there = {test["name"] for test in listing["tests"]}
    seconds = {test.name: test.seconds for test in tests if test.state == "passed"}
    costs = costs_of(seconds, locks_of(listing))
    table = {name: cost for name, cost in table.items() if name in there and name not in costs}
    table.update((name, (round(cost), cores_of(name, seconds[name], cpu_seconds)))
                 for name, cost in costs.items() if name not in fixed and cost >= 1.0)
    with open(path, "w", encoding="utf-8") as file:
        file.write(HEADER)
        for name, (cost, cores) in sorted(table.items(), key=lambda entry: (-entry[1][0], entry[0])):
            file.write(f"{cost} {cores:g} {name}\n")
    return len(table)
