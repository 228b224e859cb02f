"""Recordings with one oddity each, beside those of the cases folder (TOPOGEO_CASES, ../shared/cases).

    python3 tests/bench/odd_recordings list
    python3 tests/bench/odd_recordings make NAME...      # or all
    python3 tests/bench/odd_recordings map NAME...       # makes, maps and compares with the known truth

TOPOGEO names the program, CASES_WORK the folder for files. A row of `map` has the exit code, the scans with a pose, the
rms error of the trajectory after the best alignment, and the last message of the program.
"""
import re
import subprocess

from common import *  # noqa: F403
import carmen_logs, carmen_variants, containers, files, frames, lasers, more_lasers  # noqa: E401, F401
import more_odometry, odometry, pose_messages, stamps, unusual  # noqa: E401, F401


def mapped(name):
    """A row: exit code, scans with a pose, rms error and the last message."""
    path = CASES[name]()
    out = os.path.join(cases.WORK, 'out', name)
    subprocess.run(['rm', '-rf', out], check=True)
    program = os.environ.get('TOPOGEO', os.path.join(ROOT, 'build/bin/topogeo'))
    run = subprocess.run([program, 'map', '--log', path, '--out', out], capture_output=True, text=True, timeout=900)
    lines = [x for x in run.stderr.replace('\r', '\n').split('\n') if x.startswith('topogeo')]
    scans = error = None
    if os.path.exists(out + '/trajectory.tum'):
        scans, error = error_of(out + '/trajectory.tum')
    open(os.path.join(cases.WORK, 'out', name + '.txt'), 'w').write(run.stdout + run.stderr)
    return run.returncode, scans, error, lines, run.stdout


def interpolated(true, t):
    step = true[1][0] - true[0][0]
    k = min(max(int(t / step), 0), len(true) - 2)
    while k + 2 < len(true) and true[k + 1][0] <= t:
        k += 1
    (t0, x0, y0, a0), (t1, x1, y1, _) = true[k], true[k + 1]
    u = (t - t0) / (t1 - t0)
    return x0 + u * (x1 - x0), y0 + u * (y1 - y0)


def error_of(path):
    """Poses, and their rms distance from the truth after the best alignment; the clock's zero is free."""
    rows = [[float(v) for v in line.split()] for line in open(path) if line[0] != '#']
    true, _, _ = floor.drive('std')
    best = None
    zeros = {0.0, T0, 10.0}
    for zero in zeros:
        pairs = [((r[1], r[2]), interpolated(true, r[0] - zero)) for r in rows
                 if -0.5 <= r[0] - zero <= true[-1][0] + 0.5]
        if len(pairs) < 0.5 * len(rows):
            continue
        rms = aligned_rms(pairs)
        if best is None or rms < best:
            best = rms
    return len(rows), best


def aligned_rms(pairs):
    n = len(pairs)
    ma = [sum(p[0][k] for p in pairs) / n for k in (0, 1)]
    mb = [sum(p[1][k] for p in pairs) / n for k in (0, 1)]
    dot = cross = aa = bb = 0.0
    for (ax, ay), (bx, by) in pairs:
        ax, ay, bx, by = ax - ma[0], ay - ma[1], bx - mb[0], by - mb[1]
        dot += ax * bx + ay * by
        cross += ax * by - ay * bx
        aa += ax * ax + ay * ay
        bb += bx * bx + by * by
    return math.sqrt(max(0.0, aa + bb - 2 * math.hypot(dot, cross)) / n)


def main():
    if len(sys.argv) < 2 or sys.argv[1] not in ('list', 'make', 'map'):
        sys.exit(__doc__)
    names = sys.argv[2:]
    if not names or names == ['all']:
        names = list(CASES)
    if sys.argv[1] == 'list':
        print('\n'.join(CASES))
        return
    for name in names:
        if sys.argv[1] == 'make':
            print(name, CASES[name](), flush=True)
            continue
        code, scans, error, lines, _ = mapped(name)
        text = re.sub(r'^topogeo[a-z ]*: ', '', lines[-1]) if lines else ''
        print('%-32s rc %d  %4s poses  %s m  %s' % (name, code, scans or '-', '-' if error is None else '%.3f' % error,
                                                   text[:150]), flush=True)


if __name__ == '__main__':
    main()
