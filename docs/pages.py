"""Pages that the program writes itself, for docs/site.sh: one for each algorithm, and a gallery. Their text is the head
of the algorithm's source file and what `info` and `check` print; commands make the pictures.

usage: pages.py PAGES PROGRAM    PAGES: a copy of the source, whose docs/algorithms/ and docs/gallery/ are written"""
import csv
import html
import os
import re
import subprocess
import sys

MANY, ONE = 'study/quick', 'sq18/squint_20'  # scenes of many receivers, of one

# What is drawn of an algorithm: the steps from echoes to image.
STEPS = {
    'reference': ['compress', 'upsample 4 times', 'sinc of 20 taps at the exact delay', 'sum over all pairs'],
    'bp_nearest': ['compress', 'nearest sample at the delay', 'sum over all pairs'],
    'bp_linear': ['compress', 'nearest of beta linear points', 'sum over all pairs'],
    'bp_sinc': ['compress', 'truncated sinc at the delay', 'sum over all pairs'],
    'bp_zeropad': ['compress, pad the spectrum', 'nearest sample at the delay', 'sum over all pairs'],
    'bp_farrow': ['compress into branches', 'polynomial at the delay', 'sum over all pairs'],
    'bp_fitted': ['compress', 'least-squares taps at the delay', 'sum over all pairs'],
    'bp_factorised': ['compress', 'images of subapertures', 'merge, level by level', 'interpolate pixels'],
    'rma_lbf': ['compress', 'bistatic phase, block by block', 'sum receivers', 'Stolt', 'inverse FFT'],
    'rma_pca': ['compress', 'phase centres, block by block', 'sum receivers', 'Stolt', 'inverse FFT'],
    'rma_wu': ['compress', 'broadside delays, block by block', 'sum receivers', 'Stolt', 'inverse FFT'],
    'rma_numeric': ['compress', 'exact phase, block by block', 'sum receivers', 'Stolt', 'inverse FFT'],
    'rma_delay': ['compress', 'delay each receiver by range', 'few terms a wavenumber', 'Stolt', 'inverse FFT'],
    'rma_chirp': ['compress', 'delay each receiver by range', 'few terms a wavenumber', 'chirp transforms', 'inverse FFT'],
    'wk_classic': ['compress', 'unfold wavenumbers', 'Stolt', 'inverse FFT'],
    'wk_squint': ['compress, remove centroid', 'turn the axes', 'interpolate azimuth, range', 'inverse FFT'],
    'wk_polar': ['compress', 'polar-format filter', 'Stolt', 'inverse FFT'],
    'auto': ['predict each setting', 'image by the cheapest', 'measure its error on some pixels'],
    'monostatic': ['compress', 'move each record by its delay', 'few terms a wavenumber', 'echoes of one receiver'],
}


class Site:
    def __init__(self, root, program):
        self.root, self.program = root, program
        self.environment = {**os.environ, 'OMP_NUM_THREADS': '2'}

    def folder(self, name):
        path = os.path.join(self.root, 'docs', name)
        os.makedirs(path, exist_ok=True)
        return path

    def prints(self, *arguments, status=(0,)):
        """What a command prints; it runs in docs/gallery."""
        done = subprocess.run([self.program, *arguments], cwd=self.folder('gallery'), env=self.environment, text=True,
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False)
        if done.returncode not in status:
            sys.exit(f'sasbench {" ".join(arguments)}: exit status {done.returncode}\n{done.stdout}')
        return done.stdout.rstrip()

    def write(self, name, text):
        with open(os.path.join(self.root, 'docs', name), 'w', encoding='utf-8') as page:
            page.write(text)


def drawing(steps):
    """Boxes from the echoes to the image, as SVG."""
    texts = ['echoes', *steps]
    if not steps[-1].startswith(('echoes', 'measure')):
        texts.append('image')
    out, x = [], 0
    for k, text in enumerate(texts):
        width = 7 * len(text) + 20
        if k:
            out.append(f'<path d="M{x} 20h24m-6 -4 6 4-6 4" fill="none" stroke="#666"/>')
            x += 26
        out.append(f'<rect x="{x}" y="4" width="{width}" height="32" rx="4" fill="#eef3f8" stroke="#567"/>'
                   f'<text x="{x + width / 2}" y="25" text-anchor="middle">{html.escape(text)}</text>')
        x += width + 2
    return (f'<svg viewBox="-2 0 {x + 4} 40" width="{x + 4}" style="max-width:100%" role="img" font-size="13" '
            f'font-family="sans-serif" fill="#123">{"".join(out)}</svg>')


def escaped(text):
    """Text as Markdown, but for what backticks enclose."""
    return ''.join(part if k % 2 else re.sub(r'([\\*_\[\]<>|#])', r'\\\1', part)
                   for k, part in enumerate(re.split('(`[^`]*`)', text)))


def head(path):
    """The comment at a source file's head, as Markdown: paragraphs; indented lines stay as they are."""
    with open(path, encoding='utf-8') as file:
        comment = re.search(r'/\*(.*?)\*/', file.read(), re.S).group(1)
    parts = []
    for part in re.split(r'\n\s*\n', comment):
        lines = [line.rstrip() for line in part.split('\n')]
        if all(line.startswith('       ') for line in lines if line):
            parts.append('```text\n' + '\n'.join(line[7:] for line in lines) + '\n```')
        else:
            text = escaped(' '.join(line.strip() for line in lines).strip())
            for named in re.split(r'(?:^|(?<=[.] ))(?=Cost: |Error[: ,])', text):
                title = re.match('Cost|Error', named)
                named = re.sub('^(Cost|Error): (.)', lambda found: found.group(2).upper(), named)
                parts.append((f'## {title.group()}\n\n' if title else '') + named.strip())
    return '\n\n'.join(parts)


def conditions(site, *arguments):
    printed = site.prints('check', *arguments, '--all', status=(0, 1)).partition('\nSensitivities')[0]
    return f'```text\n$ sasbench check {" ".join(arguments)} --all\n{printed}\n```'


def pictures_of(site, scene, names):
    """Run some algorithms; their pictures by name."""
    folder = scene.replace('/', '_')
    specs = [part for name in names for part in ('-a', name)]
    site.prints('run', scene, *specs, '-o', folder)
    with open(os.path.join(site.folder('gallery'), folder, 'measurements.csv'), encoding='utf-8', newline='') as file:
        rows = list(csv.DictReader(line for line in file if not line.startswith('#')))
    found = {}
    for name in names:
        mine = [file for file in os.listdir(os.path.join(site.folder('gallery'), folder))
                if re.fullmatch(rf'{folder}-{name}(_.*)?\.png', file)]
        row = next(row for row in rows if row['algorithm'] == name)
        found[name] = f'{folder}/{min(mine, key=len)}' if mine else None, row
    return found


def page_of(site, name, scene, picture):
    source = 'automatic' if name == 'auto' else name
    file, row = picture if picture else (None, None)
    info = site.prints('info', name)
    summary = info.split('\n')[0].partition(': ')[2]
    parts = [f'# {name}', escaped(summary[:1].upper() + summary[1:]) + '.', drawing(STEPS[name]),
             head(os.path.join(site.root, 'algorithms', 'methods', source + '.c'))]
    if file:
        parts += [f'![image, and its difference to the exact image](../gallery/{file})',
                  f'`sasbench run {scene} -a {name} -o DIR` made the picture: the image, and its difference to the '
                  f'exact image. Relative error {float(row["error"]):.1e}.']
    parts += ['## Settings', f'```text\n$ sasbench info {name}\n{info}\n```',
              '[Conditions](../conditions.md) has what it needs of a scene, and `sasbench check SCENE` tells before any '
              'work.']
    if name not in ('auto', 'monostatic'):
        parts += ['## Conditions', conditions(site, scene, '-a', name)]
    site.write(f'algorithms/{name}.md', '\n\n'.join(parts) + '\n')


def gallery(site, many):
    commands = [('sweep', MANY, '-a', 'bp_zeropad', '-o', 'sweep'),
                ('image', '--scene', 'study/speckle', '-a', 'rma_delay', '-o', 'speckle.png'),
                ('image', '--scene', ONE, '-a', 'wk_squint', '-o', 'squint.png')]
    for command in commands:
        site.prints(*command)
    folder = MANY.replace('/', '_')
    pictures = [(f'sasbench run {MANY} -o {folder}', f'{folder}/{folder}-error_time.png',
                 'Relative error against run time, an algorithm each.'),
                (f'sasbench run {MANY} -o {folder}', f'{folder}/{folder}-slices.png',
                 'Slices through a target along the track, and their difference to the exact image.'),
                ('sasbench ' + ' '.join(commands[0]), f'sweep/{folder}-error_time.png', 'All settings of one interpolator.'),
                ('sasbench ' + ' '.join(commands[1]), 'speckle.png', 'A field of scatterers by range migration.'),
                ('sasbench ' + ' '.join(commands[2]), 'squint.png', 'A squinted beam by omega-k.')]
    parts = ['# Gallery', 'Each picture was made by the command above it when these pages were built.']
    for command, file, text in pictures:
        parts += [f'```sh\n{command}\n```', f'![{text}](gallery/{file})', text]
    parts += [f'The pages of the [algorithms](algorithms/index.md) have the images of `{MANY}`, '
              f'such as that of [{min(many)}](algorithms/{min(many)}.md).']
    site.write('gallery.md', '\n\n'.join(parts) + '\n')


def main():
    site = Site(os.path.abspath(sys.argv[1]), os.path.abspath(sys.argv[2]))
    site.folder('algorithms')
    listed = [line.split()[0] for line in site.prints('list').split('\n') if line and line[0] != ' ']
    missing = [name for name in listed if name not in STEPS]
    if missing:
        sys.exit(f'docs/pages.py: STEPS has no {", ".join(missing)}')
    names = [name for name in listed if name not in ('auto', 'monostatic')]
    many = pictures_of(site, MANY, [name for name in names if not name.startswith('wk_')])
    one = pictures_of(site, ONE, [name for name in names if name.startswith('wk_')])
    for name in STEPS:
        page_of(site, name, ONE if name in one else MANY, one.get(name) or many.get(name))
    site.write('algorithms/index.md', '# Algorithms\n\nA page each: what it does, its cost, error, settings and '
               'conditions.\n\n```{toctree}\n:maxdepth: 1\n' + '\n'.join(STEPS) + '\n```\n')
    gallery(site, many)


main()
