/* The tables of commands and options (commands.h). */
#include "command/commands.h"

#include <limits.h>
#include <string.h>

const struct command commands[] = {
    {"run", "compare algorithms on scenes: error against run time",
     "([SCENE ...] | --echoes FILE.mat [--grid GRID]) [--algorithm SPEC ...] [-o DIR] [--all] [--flops] "
     "[--memory BYTES] [--shard I/N] [--timeout S]",
     "compare algorithms on scenes, or on recorded echoes: the fastest for each of four errors; with --memory in tiles",
     "oategLFXUY", 0, INT_MAX, command_run, true, .every = true,
     .example = "run study/quick -a bp_nearest -a rma_delay"},
    {"report", "make one page of a results folder, or a site of several", "(DIR | --site DIR ... -o OUT)",
     "make one page of a results folder, DIR/report.html; or a site of several, which keeps kinds of machine apart: "
     "OUT/index.html",
     "oZ", 1, INT_MAX, command_report, .example = "report results/latest"},
    {"list", "list the algorithms", "", "list the algorithms, with summary, reference and traits", "", 0, 0,
     command_list, .example = "list"},
    {"info", "explain an algorithm's settings, or an echo or image file", "(NAME | PLUGIN.so | FILE.mat)",
     "print an algorithm's parameters, with default, bounds and sweep; or the content of an echo or image file, with a "
     "grid to begin with",
     "", 1, 1, command_info, .example = "info bp_linear"},
    {"check", "which algorithms can image a scene, and which conditions fail",
     "(SCENE | --echoes FILE.mat [--grid GRID]) [--algorithm SPEC ...] [--all]",
     "check, before any work, which algorithms can image a scene, and which conditions fail or are near their limit; "
     "exit status 1 where an algorithm is refused",
     "aegL", 0, 1, command_check, .every = true, .example = "check study/swath"},
    {"plan", "the fastest algorithm and settings within an error",
     "(SCENE | --echoes FILE.mat [--grid GRID]) [--error E | --time S] [--memory BYTES] [--nodes N] "
     "[-o FILE.csv] [--all]",
     "choose the fastest settings within an error, or the most exact within a time; exit status 1 where nothing fits",
     "oegtETYDL", 0, 1, command_plan, .example = "plan study/swath --error 1e-2"},
    {"scenes", "draw a random scene from a seed", "random --seed N [-o FILE.cfg]",
     "draw a scene from a seed, of any band, array and range", "oS", 1, 1, command_scenes,
     .example = "scenes random --seed 7 -o seven.cfg"},
    {"simulate", "write a scene's echoes", "SCENE -o FILE.mat", "write a scene's echoes", "ot", 1, 1, command_simulate,
     .example = "simulate study/quick -o echoes.mat"},
    {"convert", "make an echo file of recordings in a public layout", "IN ... -o FILE.mat",
     "make an echo file of recordings in a public layout, which their fields decide: AFRL Gotcha, AirSAS, zea, "
     "USTB UFF, CPHD",
     "o", 1, INT_MAX, command_convert, .example = "convert pass1.mat pass2.mat -o echoes.mat"},
    {"image", "form one image",
     "(--scene SCENE | --echoes FILE.mat [--grid GRID]) --algorithm SPEC -o (FILE.mat | FILE.png | FILE.svg) [--range "
     "DB] "
     "[--verify] [(--tile NxM | --memory BYTES) [--shard I/N]] [--timeout S]",
     "form one image, as numbers or as a picture; with --tile or --memory it continues where it was ended",
     "oseagtRWIXYU", 0, 0, command_image, .example = "image -e echoes.mat -a bp_sinc:taps=8 -o image.mat"},
    {"show", "draw an image file", "FILE.mat [-o FILE.png] [--range DB]",
     "draw an image file; the picture is beside it, or at -o", "oR", 1, 1, command_show,
     .example = "show image.mat --range 40"},
    {"score", "measure an image that another program formed",
     "(IMAGE.mat | IMAGE.npy) (SCENE | --echoes FILE.mat [--grid GRID]) [--name NAME] [--seconds S] [-o DIR]",
     "measure an image that another program formed of a scene's echoes, and add its row to a results folder", "oegtNK",
     1, 2, command_score, .example = "score image.mat study/quick --name mine"},
    {"filter", "remove the echoes from outside a target area",
     "(SCENE | --echoes FILE.mat) [--algorithm wk_polar:...] -o FILE.mat",
     "remove the echoes from outside a target area, and print each target's kept energy", "oeat", 0, 1, command_filter,
     .example = "filter pf05/nine -o nine.mat"},
    {"compare", "how two results, two images or two programs differ",
     "(OLD NEW | IMAGE.mat IMAGE.mat [-o FILE.png] | --ab OLD_BINARY NEW_BINARY [SCENE ...] [--algorithm SPEC ...]) "
     "[--markdown FILE] [--json FILE]",
     "list what got worse between two results folders or CSV files; how two image files differ; or what is slower of "
     "two programs, run side by side",
     "oaBMJ", 2, INT_MAX, command_compare, .example = "compare results/old results/latest"},
    {"measure", "", "", "the other end of `compare --ab`, which starts it", "", 0, 0, command_measure, false, true},
    {"baseline", "measure the quality and work that the tests compare with", "[-o FILE.csv]",
     "measure quality and work of the gate's scenes anew, into results/baseline.csv", "ot", 0, 0, command_baseline,
     .example = "baseline -o now.csv"},
    {"merge", "join the results folders of shards", "DIR ... -o DIR",
     "join the results folders of shards; a folder for each kind of machine", "o", 1, INT_MAX, command_merge,
     .example = "merge parts/1 parts/2 -o results/sweep"},
    {"reproduce", "the papers' tables and claims beside ours", "[ID ...] [-o DIR] [--quick | --docs | --shard I/N]",
     "measure the papers' tables, figures and claims again, beside the printed numbers", "otXQG", 0, INT_MAX,
     command_reproduce, true, .example = "reproduce --quick"},
    {"sweep", "error against run time, each algorithm over its settings",
     "([SCENE ...] | --echoes FILE.mat [--grid GRID]) [--algorithm SPEC ...] [--precision float|double] [-o DIR] "
     "[--all] [--shard I/N] [--timeout S]",
     "measure error against run time, each algorithm over its settings", "oategPLXU", 0, INT_MAX, command_sweep, true,
     .every = true, .example = "sweep study/quick -a bp_linear"},
    {"phase", "phase errors of the two-dimensional spectra (LBF21)", "([SCENE] [-o DIR] | --at FILE.csv)",
     "compute phase errors of the two-dimensional spectra (LBF21 Figs 2-9)", "oA", 0, 1, command_phase,
     .example = "phase"},
    {"stability", "digits lost on extreme scenes in all rounding modes",
     "[SCENE ...] [--algorithm SPEC ...] [-o DIR] [--quick] [--shard I/N]",
     "image extreme scenes in all rounding modes: verdicts and digits lost, against results/stability.csv", "oaQX", 0,
     INT_MAX, command_stability, .example = "stability --quick"},
    {"conformance", "test every promise of one algorithm, also of a plug-in", "SPEC [--timeout S]",
     "test every promise of one algorithm: image, bits, memory, work, settings; exit status 1 where one is broken", "U",
     1, 1, command_conformance, .example = "conformance bp_sinc"},
    {"bench", "speed of the engines against the processor's peak", "[SPEC ...] [-o DIR]",
     "measure the speed of the engines, or of the SPECs, against the processor's peak and the scalar reference loop",
     "ot", 0, INT_MAX, command_bench, .example = "bench"},
    {.name = NULL},
};

#define IN_TASK(field) offsetof(struct task, field)
const struct named options[] = {
    {'o', "output", "PATH", "file or folder of the result", IN_TASK(output)},
    {'s', "scene", "SCENE", "a path, or a name below scenes/ without .cfg", IN_TASK(scene)},
    {'e', "echoes", "FILE", "recorded echoes in MATLAB format", IN_TASK(echoes)},
    {'a', "algorithm", "SPEC", "NAME, PLUGIN.so or external:COMMAND, then :key=value,...; all take precision=double",
     0},
    {'g', "grid", "GRID", "xmin:xstep:xcount,rmin:rstep:rcount[,angle] (m, degrees)", IN_TASK(grid)},
    {'t', "threads", "N", "OpenMP threads, 1 to 1024", IN_TASK(threads)},
    {'R', "range", "DB", "range of a picture below its peak, 60 dB unless given", IN_TASK(range)},
    {'I', "tile", "NxM", "form so many pixels along x and r at a time", IN_TASK(tile)},
    {'U', "timeout", "S", "longest silence of an external program, 600 s unless given", IN_TASK(timeout)},
    {'X', "shard", "I/N", "take the I-th of N parts of the work", IN_TASK(shard)},
    {'P', "precision", "WHICH", "float or double; both unless given, or stated by a SPEC", IN_TASK(precision)},
    {'E', "error", "E", "of the image after one gain (L2), 1e-3 unless given", IN_TASK(error)},
    {'T', "time", "S", "in place of --error: the least error within a run time", IN_TASK(time)},
    {'Y', "memory", "BYTES", "most memory of the image's process, as 2G; `plan`: 4G", IN_TASK(memory)},
    {'D', "nodes", "N", "the time on so many machines such as this one", IN_TASK(nodes)},
    {'S', "seed", "N", "a whole number from 0 to 1e15", IN_TASK(seed)},
    {'N', "name", "NAME", "of the image's program; the file's name unless given", IN_TASK(name)},
    {'K', "seconds", "S", "run time of that program; the row marks it as stated", IN_TASK(seconds)},
    {'A', "at", "FILE.csv", "points: columns d, r, F, f, fc, v, c", IN_TASK(at)},
    {'B', "ab", NULL, "run two programs side by side and compare their times", IN_TASK(ab)},
    {'Q', "quick", NULL, "less: one scene of each family (`stability`), or no times (`reproduce`)", IN_TASK(quick)},
    {'L', "all", NULL, "print every line, not the answer alone", IN_TASK(all)},
    {'F', "flops", NULL, "count FLOPs by the papers' formulas as well", IN_TASK(flops)},
    {'W', "verify", NULL, "measure the image's error on some of its pixels", IN_TASK(verify)},
    {'G', "docs", NULL, "write one page a paper into docs/papers", IN_TASK(docs)},
    {'Z', "site", NULL, "several folders as a site, by kind of machine", IN_TASK(site)},
    {'M', "markdown", "FILE", "the findings as a comment for a CI", IN_TASK(markdown)},
    {'J', "json", "FILE", "the findings for trackers of benchmarks", IN_TASK(json)},
    {'h', "help", NULL, NULL, 0},
    {.name = NULL},
};
_Static_assert(sizeof options / sizeof *options <= OPTIONS_MOST + 1, "OPTIONS_MOST is too small");

const char commands_exit[] = "Exit status: 0 done, 1 a run failed or got worse, 2 bad usage or bad input.";

bool command_takes(const struct command *command, const struct named *option)
{
    return strchr(command->options, option->letter) != NULL;
}
