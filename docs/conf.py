"""The pages as a site (docs/site.sh). Links lead to the same files as in a clone; those to files that are no pages are
downloads."""
project = 'sasbench'
author = 'the sasbench authors'
extensions = ['myst_parser']
html_theme = 'furo'
html_title = project
html_static_path = ['site.css']
html_css_files = ['site.css']
root_doc = 'docs/index'
include_patterns = ['*.md', 'docs/*.md', 'docs/papers/*.md', 'docs/algorithms/*.md', 'algorithms/README.md',
                    'results/README.md', 'scenes/README.md']
myst_heading_anchors = 3
highlight_language = 'none'  # a block without a language is what a command prints


def first_page(app, error):
    if not error and app.builder.name == 'html':
        with open(f'{app.outdir}/index.html', 'w') as page:
            page.write('<!doctype html><meta http-equiv="refresh" content="0; url=docs/index.html">\n')


def setup(app):
    app.connect('build-finished', first_page)
