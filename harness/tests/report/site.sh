#!/bin/sh
# The pages of docs/ as a site, by docs/conf.py: no warning of Sphinx, and every link between its files leads somewhere.
# Usage: site.sh SOURCE_ROOT PROGRAM. Exit status 77 without Sphinx.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
"$1/docs/site.sh" "$1" "$2" "$folder"
python3 - "$folder/site" <<'END'
import html.parser, os, sys, urllib.parse
class Page(html.parser.HTMLParser):
    def __init__(self, path):
        super().__init__()
        self.links, self.ids = [], set()
        with open(path) as file:
            self.feed(file.read())
    def handle_starttag(self, tag, attributes):
        for name, value in attributes:
            if name in ('href', 'src') and tag in ('a', 'img'):
                self.links.append(value)
            elif name == 'id':
                self.ids.add(value)
pages = {os.path.join(folder, name): None for folder, _, names in os.walk(sys.argv[1]) for name in names
         if name.endswith('.html')}
for path in pages:
    pages[path] = Page(path)
faults, links = 0, 0
for path, page in pages.items():
    for link in page.links:
        url = urllib.parse.urlsplit(link)
        if url.scheme or link == '#':
            continue
        links += 1
        to = os.path.normpath(os.path.join(os.path.dirname(path), urllib.parse.unquote(url.path))) if url.path else path
        place = urllib.parse.unquote(url.fragment)
        if not os.path.isfile(to) or place and to in pages and place not in pages[to].ids:
            print(f'{os.path.relpath(path, sys.argv[1])}: {link} leads nowhere')
            faults += 1
print(f'{len(pages)} pages, {links} links, {faults} lead nowhere')
sys.exit(faults > 0 or links < 1000)
END
