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


# ---- VDMA LIF and VDA 5050 ------------------------------------------------------------------------

POSITION = {"type": "object", "required": ["x", "y"],
            "properties": {"x": {"type": "number"}, "y": {"type": "number"}}}
TEXT = {"type": "string", "minLength": 1}


def rows(item, least=0):
    return {"type": "array", "items": item, "minItems": least}


def fields(needed, **optional):
    return {"type": "object", "required": list(needed), "properties": {**needed, **optional}}


LIF = fields({
    "metaInformation": fields({"projectIdentification": TEXT, "creator": TEXT,
                               "exportTimestamp": {"type": "string", "pattern": "^[0-9]{4}-[0-9]{2}-"
                                                   "[0-9]{2}T[0-9:]{8}[.][0-9]{2,}Z$"},
                               "lifVersion": {"const": "1.0.0"}}),
    "layouts": rows(fields({
        "layoutId": TEXT, "layoutVersion": {"type": "string", "pattern": "^[1-9][0-9]*$"},
        "nodes": rows(fields({"nodeId": TEXT, "mapId": TEXT, "nodePosition": POSITION,
                              "vehicleTypeNodeProperties": rows(fields({"vehicleTypeId": TEXT}), 1)})),
        "edges": rows(fields({
            "edgeId": TEXT, "startNodeId": TEXT, "endNodeId": TEXT,
            "vehicleTypeEdgeProperties": rows(fields(
                {"vehicleTypeId": TEXT, "rotationAllowed": {"type": "boolean"}},
                maxSpeed={"type": "number", "exclusiveMinimum": 0},
                trajectory=fields({"knotVector": rows({"type": "number", "minimum": 0, "maximum": 1}),
                                   "controlPoints": rows(POSITION, 2)},
                                  degree={"type": "integer", "minimum": 1})), 1)})),
        "stations": rows(fields({"stationId": TEXT, "interactionNodeIds": rows(TEXT, 1)},
                                stationPosition=POSITION)),
    }), 1)})


def conforms(value, schema):
    import jsonschema
    try:
        jsonschema.validate(value, schema)
    except jsonschema.ValidationError as error:
        sys.exit(f"{list(error.absolute_path)}: {error.message}")


def unique(values, what):
    values = list(values)
    need(len(values) == len(set(values)), f"{what}: an id twice")
    return set(values)


def lif(path):
    top = json.load(open(path))
    conforms(top, LIF)
    layout = top["layouts"][0]
    nodes = unique((n["nodeId"] for n in layout["nodes"]), "nodes")
    places = {n["nodeId"]: n["nodePosition"] for n in layout["nodes"]}
    unique((e["edgeId"] for e in layout["edges"]), "edges")
    unique((s["stationId"] for s in layout["stations"]), "stations")
    for edge in layout["edges"]:
        for end in (edge["startNodeId"], edge["endNodeId"]):
            need(end in nodes, f"edge {edge['edgeId']}: node {end}")
        for properties in edge["vehicleTypeEdgeProperties"]:
            curve = properties["trajectory"]
            points, knots = curve["controlPoints"], curve["knotVector"]
            need(len(knots) == len(points) + curve["degree"] + 1, "number of knots")
            need(knots == sorted(knots) and knots[0] == 0 and knots[-1] == 1, "knots")
            need(points[0] == places[edge["startNodeId"]], f"{edge['edgeId']} starts elsewhere")
            need(points[-1] == places[edge["endNodeId"]], f"{edge['edgeId']} ends elsewhere")
    for station in layout["stations"]:
        need(nodes.issuperset(station["interactionNodeIds"]), "station at no node")
    print(len(nodes), len(layout["edges"]), len(layout["stations"]))


ID = {"type": "string", "pattern": "^[A-Za-z0-9_.:-]+$"}
LIMITATION = {"enum": ["SOFT", "RESTRICTED", "STRICT"]}
ACTIONS = rows({"type": "object"})
ZONE_FIELDS = {
    "BLOCKED": {}, "SPEED_LIMIT": {"maximumSpeed": {"type": "number", "exclusiveMinimum": 0}},
    "DIRECTED": {"direction": {"type": "number"}, "directedLimitation": LIMITATION,
                 "limitation": LIMITATION},  # text and schema of 3.0.0
    "ACTION": {"entryActions": ACTIONS, "duringActions": ACTIONS, "exitActions": ACTIONS}}


def zones(path):
    top = json.load(open(path))
    conforms(top, fields({
        "headerId": {"type": "integer", "minimum": 0, "maximum": 2**32 - 1},
        "timestamp": {"type": "string", "pattern": "^[0-9-]{10}T[0-9:]{8}[.][0-9]{3}Z$"},
        "version": {"const": "3.0.0"}, "manufacturer": ID, "serialNumber": ID,
        "zoneSet": fields({"mapId": ID, "zoneSetId": ID, "zones": rows(fields(
            {"zoneId": ID, "zoneType": {"enum": list(ZONE_FIELDS)}, "vertices": rows(POSITION, 3)},
            zoneDescriptor={"type": "string"}))})}))
    unique((z["zoneId"] for z in top["zoneSet"]["zones"]), "zones")
    for zone in top["zoneSet"]["zones"]:
        conforms(zone, fields(ZONE_FIELDS[zone["zoneType"]]))
        corners = [(v["x"], v["y"]) for v in zone["vertices"]]
        area = sum(a[0] * b[1] - a[1] * b[0] for a, b in zip(corners, corners[1:] + corners[:1]))
        need(area > 0, f"{zone['zoneId']} goes round clockwise")
    print(top["zoneSet"]["mapId"], *(z["zoneType"] for z in top["zoneSet"]["zones"]))


# ---- Open-RMF fleet adapter ----------------------------------------------------------------------

def rmf(path):
    import yaml
    top = yaml.safe_load(open(path))
    need(isinstance(top["levels"], dict), "levels is no map")
    names, limits = [], 0
    for level, content in top["levels"].items():
        for vertex in content["vertices"]:
            need(len(vertex) == 3 and isinstance(vertex[2], dict), f"vertex {vertex}")
            need(all(isinstance(c, (int, float)) for c in vertex[:2]), f"vertex {vertex}")
            if vertex[2]["name"]:
                names.append(vertex[2]["name"])
        for lane in content["lanes"]:
            need(len(lane) == 3 and isinstance(lane[2], dict), f"lane {lane}")
            need(0 <= lane[0] < len(content["vertices"]), f"lane {lane}")
            need(0 <= lane[1] < len(content["vertices"]) and lane[0] != lane[1], f"lane {lane}")
            limits += "speed_limit" in lane[2]
        print(level, len(content["vertices"]), len(content["lanes"]), limits)
    unique(names, "names")
    need(top["lifts"] == {} and top["doors"] == {}, "lifts, doors")
    for name in sorted(names):
        print(name)


# ---- pictures ------------------------------------------------------------------------------------

def picture(path):
    from PIL import Image
    image = Image.open(path)
    image.load()
    need(len(image.convert("L").getcolors()) > 3, "nothing is drawn")
    print(*image.size)


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
    FORMATS = [geojson, graphml, grid, g2o, lif, zones, rmf, picture]
    {f.__name__: f for f in FORMATS}[sys.argv[1]](sys.argv[2])
