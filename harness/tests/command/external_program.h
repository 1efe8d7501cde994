/* A program that does what its first argument names, beside the words of docs/plugins.md: python3, no more. */
#ifndef SASBENCH_TEST_EXTERNAL_PROGRAM_H
#define SASBENCH_TEST_EXTERNAL_PROGRAM_H

static const char bad_py[] =
    "import os, signal, subprocess, sys, time\n"
    "kind = sys.argv[1]\n"
    "hears, says = os.fdopen(3), os.fdopen(4, 'wb', 0)\n"
    "def say(text): says.write(b'sasbench1 ' + text + b'\\n')\n"
    "def image(numbers, form='<c16', many=None):\n"
    "    text = \"{'descr': '%s', 'fortran_order': False, 'shape': (%d,), }\" % (form, many or len(numbers) // 16)\n"
    "    with open(folder + '/image.npy', 'wb') as file:\n"
    "        file.write(b'\\x93NUMPY\\x01\\0' + len(text).to_bytes(2, 'little') + text.encode() + numbers)\n"
    "zeros, nan, ones = bytes(16 * 793), b'\\0\\0\\0\\0\\0\\0\\xf8\\x7f' * 2 * 793, b'\\0\\0\\0\\0\\0\\0\\xf0\\x3f' * "
    "2 * 793\n"
    "def plan():\n"
    "    if kind == 'eof': os.close(4); time.sleep(1000)\n"
    "    if kind == 'exit': sys.exit(3)\n"
    "    if kind == 'raise': raise ValueError('no such\\x1b thing')\n"
    "    if kind == 'garbage': says.write(b'hello\\n')\n"
    "    if kind == 'token': says.write(b'sasbench2 ok\\n')\n"
    "    if kind == 'zero': says.write(b'sasbench1 ok\\0\\n')\n"
    "    if kind == 'long': says.write(5000000 * b'x')\n"
    "    if kind == 'silent': time.sleep(1000)\n"
    "    if kind == 'half': says.write(b'sasbench1 o'); sys.exit(0)\n"
    "    if kind == 'refuses': say(b'unsupported too many\\x1b pings')\n"
    "    if kind == 'noisy': os.write(1, 200000 * b'tick\\n')\n"
    "    if kind == 'stubborn': signal.signal(signal.SIGTERM, signal.SIG_IGN)\n"
    "    if kind == 'bomb':\n"
    "        for k in range(40): subprocess.Popen(['sh', '-c', 'while :; do sleep 31557.25; done'],\n"
    "                                             start_new_session=k % 2 > 0)\n"
    "    say(b'ok')\n"
    "    if kind == 'early': say(b'took 0')\n"
    "def execute():\n"
    "    if kind == 'hang': time.sleep(1000)\n"
    "    if kind == 'crash': os.kill(os.getpid(), signal.SIGSEGV)\n"
    "    if kind == 'link': os.symlink('/dev/zero', folder + '/image.npy')\n"
    "    elif kind == 'pipe': os.mkfifo(folder + '/image.npy')\n"
    "    elif kind == 'folder': os.mkdir(folder + '/image.npy')\n"
    "    elif kind == 'text': open(folder + '/image.npy', 'w').write('an image')\n"
    "    elif kind == 'size': image(zeros[16:])\n"
    "    elif kind == 'short': image(zeros[16:], many=793)\n"
    "    elif kind == 'type': image(zeros, form='<i8')\n"
    "    elif kind == 'nan': image(nan)\n"
    "    elif kind == 'memo': image(ones)\n"
    "    elif kind not in ('none', 'late'): image(zeros)\n"
    "    if kind == 'threads':\n"
    "        begin = os.times()\n"
    "        os.system('for k in $(seq 60); do timeout .5 sh -c \"while :; do :; done\" & done; wait')\n"
    "        used = [now - then for now, then in zip(os.times(), begin)]\n"
    "        open('processors', 'a').write('%g ' % ((used[2] + used[3]) / used[4]))\n"
    "    say({'clock': b'took 1000', 'negative': b'took -1', 'word': b'took long'}.get(kind, b'took 0'))\n"
    "    if kind == 'late': time.sleep(.2); image(zeros)\n"
    "for line in hears:\n"
    "    word, _, rest = line.rstrip('\\n').partition(' ')[2].partition(' ')\n"
    "    if word == 'plan': folder = rest; plan()\n"
    "    elif word == 'execute': execute()\n"
    "    elif kind == 'stubborn': time.sleep(1000)\n"
    "    else: break\n";

/* How it loses its row; at first those that a --timeout ends. */
static const struct {
    const char *kind, *status, *reason;
} lost[] = {
    {"silent", "failed", "was silent for 5 s during `plan` (--timeout)"},
    {"hang", "failed", "was silent for 5 s during `execute` (--timeout)"},
    {"eof", "failed", "closed its descriptor 4 during `plan`"},
    {"exit", "failed", "ended with exit status 3 during `plan`"},
    {"raise", "failed", "status 1 during `plan`; it printed last: ValueError: no such? thing"},
    {"garbage", "failed", "said 'hello' to `plan`, must be 'sasbench1 ok' or 'sasbench1 unsupported REASON'"},
    {"token", "failed", "said 'sasbench2 ok' to `plan`"},
    {"zero", "failed", "said a line with a zero byte, 'sasbench1 ok'"},
    {"long", "failed", "said a line of more than 4096 bytes, 'xxx"},
    {"half", "failed", "ended with exit status 0 during `plan`, within a line"},
    {"refuses", "unsupported", "too many? pings"},
    {"early", "failed", "said 'sasbench1 took 0' without being asked"},
    {"crash", "failed", "ended by signal 11 (Segmentation fault) during `execute`"},
    {"none", "failed", "said `took` without an image.npy: No such file"},
    {"late", "failed", "said `took` without an image.npy: No such file"},
    {"link", "failed", "said `took` without an image.npy: Too many levels of symbolic links"},
    {"pipe", "failed", "image.npy is not a file"},
    {"folder", "failed", "image.npy is not a file"},
    {"text", "failed", "image.npy: not an .npy file"},
    {"size", "failed", "image.npy: the array is [792], the grid has 13 ranges and 61 places"},
    {"short", "failed", "image.npy: ends after 792 of 793 numbers"},
    {"type", "failed", "image.npy: its array is {'descr': '<i8'"},
    {"nan", "failed", "values that are not finite"},
    {"memo", "failed", "half of the pings negated have the same image"},
    {"clock", "failed", "said that it took 1e+03 s"},
    {"negative", "failed", "said 'sasbench1 took -1' to `execute`, must be 'sasbench1 took SECONDS'"},
    {"word", "failed", "said 'sasbench1 took long' to `execute`"},
    /* and those that keep it */
    {"bomb", "ok", ""},
    {"stubborn", "ok", ""},
    {"noisy", "ok", ""},
};

#endif
