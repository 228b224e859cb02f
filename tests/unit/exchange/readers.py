"""Reads exported files as the programs do that they are for, and prints what it found.

readers.py FORMAT FILE: exit code 1 and a line that says what is wrong when the file breaks a rule.
The rules are those of docs/exchange.md; nothing here uses code of the project.
"""
import json
import math
import struct
import sys


def need(condition, text):
    if not condition:
        sys.exit(text)


def float32(value):
    return struct.unpack("f", struct.pack("f", value))[0]


# ---- Nav2 route server ----------------------------------------------------------------------------

def check_metadata(value, where):
    """Values that Nav2 can convert; numeric tags must be floats in the text of the file."""
    need(value is not None, f"{where}: null")
    if isinstance(value, dict):
        for key, item in value.items():
            check_metadata(item, f"{where}.{key}")
    elif isinstance(value, list):
        for item in value:
            need(isinstance(item, (bool, int, float, str)), f"{where}: array of {type(item)}")


def geojson(path):
    top = json.load(open(path))
    nodes, edges, ids = {}, [], set()
    for i, feature in enumerate(top["features"]):
        where = f"features[{i}]"
        kind = feature["geometry"]["type"]
        properties = feature["properties"]
        if kind == "Point":
            x, y = feature["geometry"]["coordinates"]
            number = properties["id"]
            need(isinstance(number, int) and 0 <= number < 2**32, f"{where}: id {number}")
            need(number not in (2147483647, 4294967295), f"{where}: reserved id")
            need(number not in ids, f"{where}: id {number} twice")
            need(properties.get("frame", "map") == "map", f"{where}: frame")
            nodes[number] = (float32(x), float32(y))
            ids.add(number)
        elif kind in ("LineString", "MultiLineString"):
            edges.append((properties["id"], properties["startid"], properties["endid"]))
            need(properties["id"] not in ids, f"{where}: id {properties['id']} twice")
            ids.add(properties["id"])
            for tag in ("clearance", "speed_limit", "abs_speed_limit", "penalty"):
                value = properties.get("metadata", {}).get(tag)
                need(value is None or isinstance(value, float), f"{where}: {tag} is no float")
            if "speed_limit" in properties.get("metadata", {}):
                need(0.0 < properties["metadata"]["speed_limit"] <= 100.0, f"{where}: percent")
        else:
            continue
        check_metadata(properties.get("metadata", {}), where)
    need(nodes and edges, "no node or no edge")
    for number, start, end in edges:
        need(start in nodes and end in nodes, f"edge {number}: unknown end")
    print(len(nodes), len(edges))
    return nodes, edges


# ---- NetworkX ------------------------------------------------------------------------------------

def graphml(path):
    import networkx
    graph = networkx.read_graphml(path)
    places = [n for n, d in graph.nodes(data=True) if d["kind"] == "place"]
    for _, data in graph.nodes(data=True):
        need(isinstance(data["x"], float) and isinstance(data["y"], float), "x, y are no numbers")
    for a, b, data in graph.edges(data=True):
        numbers = [float(n) for n in data["points"].split()]
        ends = [(numbers[0], numbers[1]), (numbers[-3], numbers[-2])]
        for node, end in zip((a, b), ends):
            here = (graph.nodes[node]["x"], graph.nodes[node]["y"])
            other = (graph.nodes[b if node == a else a]["x"], graph.nodes[b if node == a else a]["y"])
            need(here == end or other == end, f"edge {a}-{b} does not end at {node}")
    real = [n for n in graph if n not in places]
    print(len(real), graph.number_of_edges(), len(places), networkx.number_connected_components(graph))
    for n in places:
        print(graph.nodes[n]["name"])


# ---- map_server ----------------------------------------------------------------------------------

def grid(path):
    """Cells by the rules of ROS 2 Humble and of Jazzy, which must agree."""
    import os
    import yaml
    from PIL import Image
    keys = yaml.safe_load(open(path))
    image = Image.open(os.path.join(os.path.dirname(path), keys["image"]))
    need(image.mode == "L", f"mode {image.mode}")
    width, height = image.size
    need(len(keys["origin"]) == 3 and keys["origin"][2] == 0, "origin")
    need(keys["negate"] == 0, "negate")
    pixels = list(image.getdata())
    cells = []
    for row in range(height - 1, -1, -1):
        for pixel in pixels[row * width:(row + 1) * width]:
            if keys["mode"] == "raw":
                cells.append(pixel if pixel <= 100 else -1)
                continue
            need(keys["mode"] == "trinary", "mode")
            occ = (255 - pixel) / 255
            humble = 100 if occ > keys["occupied_thresh"] else 0 if occ < keys["free_thresh"] else -1
            o32, f32 = float32(keys["occupied_thresh"]), float32(keys["free_thresh"])
            shade = float32((255 - pixel) / 255)
            jazzy = 0 if shade <= f32 else 100 if shade >= o32 else -1
            need(humble == jazzy, f"pixel {pixel}: {humble} or {jazzy}")
            cells.append(jazzy)
    print(width, height, keys["resolution"], keys["origin"][0], keys["origin"][1])
    print(" ".join(str(c) for c in cells))


# ---- g2o -----------------------------------------------------------------------------------------

def g2o(path):
    vertices, edges, fixed = {}, 0, set()
    for number, line in enumerate(open(path), 1):
        words = line.split()
        if not words or words[0].startswith("#"):
            continue
        if words[0] == "VERTEX_SE2":
            need(len(words) == 5 and words[1] not in vertices, f"line {number}: vertex")
            vertices[words[1]] = [float(w) for w in words[2:]]
        elif words[0] == "FIX":
            need(all(w in vertices for w in words[1:]), f"line {number}: FIX before its vertex")
            fixed.update(words[1:])
        elif words[0] == "EDGE_SE2":
            need(len(words) == 12, f"line {number}: {len(words)} fields")
            need(words[1] in vertices and words[2] in vertices, f"line {number}: unknown vertex")
            a, b, c, d, e, f = (float(w) for w in words[6:])
            need(a > 0 and a * d - b * b > 0 and
                 a * (d * f - e * e) - b * (b * f - c * e) + c * (b * e - c * d) > 0,
                 f"line {number}: information is not positive definite")
            edges += 1
        else:
            sys.exit(f"line {number}: {words[0]}")
    print(len(vertices), edges, len(fixed))


if __name__ == "__main__":
    {"geojson": geojson, "graphml": graphml, "grid": grid, "g2o": g2o}[sys.argv[1]](sys.argv[2])
