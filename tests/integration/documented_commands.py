"""Tries the commands of README.md, deploy/README.md and docs/: documented_commands.py SOURCE BIN DEMO

Each command in a block or between backticks must name a subcommand and options that the program's help has. Commands of
blocks that need no live robot run as they are written, each page in a folder of its own with the files that it speaks
of: DEMO is the folder of `topogeo demo`. A command that neither runs nor is listed below as one that cannot is a fault.
"""
import glob
import os
import re
import shlex
import shutil
import subprocess
import sys
import tempfile

SOURCE, BIN, DEMO = (os.path.abspath(path) for path in sys.argv[1:4])
PROGRAMS = sorted(name for name in os.listdir(BIN) if not name.startswith('topogeo_'))
COMMAND = re.compile(r'(?:^|[\s/(])(%s)(?=\s+[^\s|])' % '|'.join(PROGRAMS))
# Commands of a robot that drives, of services on DDS or of connected devices; tests of their own run them.
LIVE = {'run', 'goto', 'explore', 'base', 'status', 'top', 'workers', 'doctor', 'follow', 'web', 'view', 'localizer',
        'simulator', 'devices', 'record', 'draw', 'store merges', 'store accept', 'store refuse'}
# Commands of blocks that cannot run here as they are written, with the reason.
UNABLE = {
    'topogeo places': 'asks a live map store',
    'topogeo match map/map.pb --stops 12,540 --prediction map --solutions 8 --json': 'has more stops than the demo',
    'topogeo match map/map.pb --stops 49,239 --prediction map --out match.png': 'has more stops than the demo',
    'topogeo match map/map.pb --stops 184,337 --prediction map --config robot.yaml': 'has more stops than the demo',
    'topogeo store remove-session both.pb 1f0a... --out monday.pb': 'the number of a session',
    'topogeo store remove-session map.sqlite 1f2e3d4c5b6a7988 --out rest.pb': 'the number of a session',
    'topogeo config --devices > /etc/topogeo/devices.yaml': 'writes to /etc',
    'topogeo store snapshot /var/lib/topogeo/map before-the-fair': 'the map of an installed service',
    'topogeo store snapshots /var/lib/topogeo/map': 'the map of an installed service',
    'topogeo store restore /var/lib/topogeo/map before-the-fair': 'the map of an installed service',
    'topogeo reproduce all --out reproduced': 'many minutes',
}


def fail(message):
    print('FAILED: ' + message)
    fail.count += 1


fail.count = 0


def plain(text):
    """A command without comment, prompt, redirection, choices in brackets and what follows it."""
    text = re.split(r'\s#(?=\s|$)|\s+\||;|&&|\)$', text)[0]
    return re.sub(r'\[(-[^\]]*)\]', r'\1', text).strip()


def commands_of(page):
    """Pairs of a command as it is written, without its folder, and the number of its block (0: no block)."""
    lines = open(page).read().split('\n')
    fenced, prose, at, block, before = False, [], 0, 0, False
    while at < len(lines):
        line = lines[at]
        at += 1
        if line.lstrip().startswith('```'):
            fenced = not fenced
        elif fenced or line.startswith('    '):
            block += not before
            before = True
            while line.endswith('\\') and at < len(lines):
                line = line[:-1] + lines[at].strip()
                at += 1
            found = re.match(r'\s*(?:\$ )?(?:sudo -u topogeo )?(?:build/bin/)?((?:%s)\s+[\w\'"/.-].*)' % '|'.join(PROGRAMS),
                             line)
            if found:
                yield plain(found[1]), block
            continue
        else:
            prose.append(line)
        before = False
    for span in re.findall(r'`([^`]+)`', '\n'.join(prose)):
        found = COMMAND.search(' '.join(span.split()))
        if found:
            yield plain(' '.join(span.split())[found.start(1):]), 0


helps = {}


def help_of(words):
    """The help of a program or subcommand, as text."""
    if words not in helps:
        run = subprocess.run([os.path.join(BIN, words[0]), *words[1:], '--help'], capture_output=True, text=True)
        helps[words] = run.stdout if run.returncode == 0 else ''
    return helps[words]


def subcommands_in(text):
    return set(re.findall(r'^  ([a-z][a-z-]*)  ', text.split('Options:')[-1], re.M))


def check_words(page, command):
    """Names what the help does not have; returns the subcommand: "store import"."""
    try:
        words = shlex.split(command)
    except ValueError as error:
        fail('%s: %s: %s' % (page, command, error))
        return ''
    # A container or an image has the program's name, and `help` comes before the subcommand.
    while len(words) > 1 and words[1] in (words[0], 'help'):
        words = words[:1] + words[2:]
    path, rest = (words[0],), words[1:]
    while rest and re.search(r'^Usage: .* SUBCOMMAND', help_of(path), re.M):
        if rest[0] not in subcommands_in(help_of(path)):
            if re.match(r'[a-z]', rest[0]):
                fail('%s: `%s`: unknown command %s' % (page, command, rest[0]))
            break
        path, rest = (*path, rest[0]), rest[1:]
    if '--' in rest:
        rest = rest[:rest.index('--')]
    for word in rest:
        option = re.match(r'--?[a-z][a-z-]*', word)
        if option and not re.search(r'(?<![\w-])%s(?![\w-])' % option[0], help_of(path)):
            fail('%s: `%s`: the help of %s has no %s' % (page, command, ' '.join(path), option[0]))
    return ' '.join(path[1:])


def folder_for_a_page():
    """A folder with what the pages speak of: logs, maps, plans, drawings."""
    folder = tempfile.mkdtemp(prefix='topogeo_pages_')
    here = lambda name: os.path.join(folder, name)  # noqa: E731
    for name in ('share', 'deploy'):
        os.symlink(os.path.join(SOURCE, name), here(name))
    os.symlink(DEMO, here('demo'))
    shutil.copy(os.path.join(DEMO, 'floor.clf.gz'), here('drive.clf.gz'))
    shutil.copy(os.path.join(DEMO, 'truth.tum'), here('truth.tum'))
    for name in ('map.pb', 'map/map.pb', 'out/map.pb', 'maps/map.pb', 'monday.pb', 'broken.pb'):
        os.makedirs(os.path.dirname(here(name)), exist_ok=True)
        shutil.copy(os.path.join(DEMO, 'map.pb'), here(name))
    for name in ('map.sqlite', 'out/map.sqlite', 'DIR/map.sqlite'):
        os.makedirs(os.path.dirname(here(name)), exist_ok=True)
        shutil.copy(os.path.join(DEMO, 'map.sqlite'), here(name))
    return folder


def copy_over(start, folder):
    """What an earlier block changed is as before; what it made stays."""
    for name in os.listdir(start):
        source, target = os.path.join(start, name), os.path.join(folder, name)
        if os.path.islink(source):
            os.path.lexists(target) or os.symlink(os.readlink(source), target)
        elif os.path.isdir(source):
            shutil.copytree(source, target, dirs_exist_ok=True)
        else:
            shutil.copy(source, target)


def prepare(folder):
    """Files that other commands of the pages make."""
    run = lambda text: subprocess.run(text, shell=True, cwd=folder, check=True, env=environment(),  # noqa: E731
                                      stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    run('topogeo store export map.pb --format pgm --out plan')
    run('topogeo convert drive.clf.gz drive.bag && topogeo convert drive.clf.gz drive.mcap')
    run('topogeo convert drive.clf.gz rosbag2_2024_05_01/')
    run('topogeo config > robot.yaml && topogeo calibrate-laser drive.clf.gz --out laser.yaml')
    run('zcat drive.clf.gz | tail -n 500 > tuesday.clf && topogeo map tuesday.clf --out tuesday'
        ' && mv tuesday/map.pb tuesday.pb && rm -r tuesday')
    run('topogeo places map.pb --add "room A=3.5,2"')
    open(os.path.join(folder, 'zones.json'), 'w').write(
        '{"zoneSet":{"mapId":"m","zoneSetId":"s","zones":[{"zoneId":"z1","zoneType":"BLOCKED","zoneDescriptor":"lab",'
        '"vertices":[{"x":0,"y":0},{"x":1,"y":0},{"x":1,"y":1}]}]}}')


def environment():
    return dict(os.environ, PATH=BIN + ':' + os.environ['PATH'])


def run(page, command, folder):
    done = subprocess.run(command, shell=True, cwd=folder, env=environment(), capture_output=True, text=True,
                          stdin=subprocess.DEVNULL)
    if done.returncode != 0:
        fail('%s: `%s` ends with %d: %s' % (page, command, done.returncode, done.stderr.strip()[-300:]))


def main():
    os.chdir(SOURCE)
    pages = ['README.md', 'deploy/README.md', *sorted(glob.glob('docs/*.md'))]
    start = folder_for_a_page()
    prepare(start)
    checked, ran, unable = 0, {}, set()
    for page in pages:
        folder, last = None, 0
        for command, block in commands_of(page):
            checked += 1
            subcommand = check_words(page, command)
            live = command.split()[0] != 'topogeo' or subcommand in LIVE
            if not block or live or subcommand.split(' ')[0] in LIVE or command in ran:
                continue
            if command in UNABLE:
                unable.add(command)
                continue
            folder = folder or tempfile.mkdtemp(prefix='topogeo_page_')
            if block != last:
                copy_over(start, folder)
            last = block
            ran[command] = page
            run(page, command, folder)
        if folder:
            shutil.rmtree(folder)
    shutil.rmtree(start)
    for command in UNABLE.keys() - unable:
        fail('`%s` is in no page any more' % command)
    print('%d commands checked, %d of them run, %d faults' % (checked, len(ran), fail.count))
    return 1 if fail.count or checked < 200 or len(ran) < 40 else 0


sys.exit(main())
