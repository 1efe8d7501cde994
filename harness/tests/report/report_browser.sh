#!/bin/sh
# A report in headless chromium, 1280 and 390 pixels wide with everything unfolded: nothing may stand beside the page or
# scroll sideways, every picture has a text in its place, every link leads somewhere, points of fronts take the focus.
# Usage: report_browser.sh PROGRAM. Prints what is wrong; exit status 1 if anything is, 77 without chromium.
set -eu
command -v chromium >/dev/null || { echo "report_browser: skipped, there is no chromium"; exit 77; }
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
"$1" sweep study/quick -a bp_zeropad:factor=2 -a bp_zeropad:factor=4 -a bp_zeropad:factor=8 \
    -o "$folder/sweep" >/dev/null 2>&1
"$1" run study/quick study/sway sq18/squint_10 -a bp_nearest -a bp_linear -a bp_farrow -a rma_delay -a wk_polar \
    -o "$folder/run" >/dev/null 2>&1
cat >"$folder/frame.html" <<'END_OF_FRAME'
<body style="margin: 0"><iframe id="frame"></iframe><script>
const [page, width] = location.hash.slice(1).split(','), frame = document.getElementById('frame'), faults = [];
const check = (page, window) => {
    for (const part of page.querySelectorAll('details')) part.open = true;
    const width = page.documentElement.clientWidth, all = [...page.body.querySelectorAll('*')];
    const name = e => (e.tagName + ' ' + (e.getAttribute('class') || '') + ' ' + e.textContent.trim().replace(/\s+/g, ' ').slice(0, 60));
    if (page.documentElement.scrollWidth > width) faults.push('the page scrolls sideways: ' + page.documentElement.scrollWidth);
    for (const e of all) {
        if (e.closest('.drawing svg') && e.tagName != 'svg') continue; // is cut at its edge
        const place = e.getBoundingClientRect();
        if (place.right > width + 1 || place.left < -1) faults.push('outside: ' + Math.round(place.right) + ' ' + name(e));
        if (!e.closest('svg') && e.scrollWidth > e.clientWidth + 1 && e.clientWidth > 0 && window.getComputedStyle(e).display != 'inline')
            faults.push('scrolls sideways: ' + name(e));
        if (e.tagName == 'IMG' && !e.alt) faults.push('no alternative text: ' + e.src.slice(0, 40));
        if (e.tagName == 'svg' && e.getAttribute('aria-hidden') != 'true' && !e.closest('[aria-label]'))
            faults.push('no alternative text: svg ' + name(e));
        if (e.tagName == 'A' && e.getAttribute('href').startsWith('#') && !page.getElementById(e.getAttribute('href').slice(1)))
            faults.push('a broken link: ' + e.getAttribute('href'));
        if (e.tagName == 'A' && !e.getAttribute('href').startsWith('#')) faults.push('FILE ' + decodeURIComponent(e.getAttribute('href')));
    }
    const points = [...page.querySelectorAll('.point')];
    for (const point of points) {
        point.focus();
        const told = point.closest('svg').nextElementSibling.textContent;
        if (page.activeElement != point || !told.includes('./sasbench run ')) faults.push('no focus, or nothing said: ' + name(point));
    }
    if (points.length == 0) faults.push('no point of a front');
};
frame.style = `width: ${width}px; height: 900px; border: 0`;
frame.onload = () => {
    try { check(frame.contentDocument, frame.contentWindow); } catch (fault) { faults.push(String(fault)); }
    document.body.innerText = ['CHECKED', ...faults].join('\n');
};
frame.src = page;
</script>
END_OF_FRAME
failed=0
for page in run sweep; do
    "$1" report "$folder/$page" >/dev/null
    for width in 1280 390; do
        chromium --headless --no-sandbox --disable-gpu --disable-dev-shm-usage --allow-file-access-from-files \
            --user-data-dir="$folder/profile" --window-size=1400,1000 --virtual-time-budget=20000 \
            --dump-dom "file://$folder/frame.html#$page/report.html,$width" 2>/dev/null |
            sed -n '/<body/,/<\/body>/p' | sed 's/<br>/\n/g; s/<[^>]*>//g' >"$folder/said"
        grep -q CHECKED "$folder/said" || { echo "$page, $width px: not checked"; failed=1; }
        sed -n 's/^FILE //p' "$folder/said" | while read -r file; do
            [ -f "$folder/$page/$file" ] || echo "a broken link: $file"
        done >"$folder/faults"
        grep -v '^CHECKED$\|^FILE \|^$' "$folder/said" >>"$folder/faults" || true
        [ ! -s "$folder/faults" ] || { sed "s|^|$page, $width px: |; 20q" "$folder/faults"; failed=1; }
    done
done
exit "$failed"
