#!/bin/sh
# Data flows one way: every folder includes its own headers and those of folders before it only. Beside the tests, a
# folder holds at most 30 sources and headers, and no two files bear one name, but for a source and its header.
# Usage: include_order.sh SOURCE_ROOT. Prints each fault; exit status 1 if there is one.
set -eu
cd "$1"
find algorithms harness -name '*.[ch]' | sort | xargs awk '
    function place(path) { return match(path, "/[^/]*$") ? substr(path, 1, RSTART - 1) : "" }
    BEGIN {
        # Each folder includes itself and those before it.
        order = "algorithms/contract algorithms/common algorithms/backprojection/pairs algorithms/backprojection " \
                "algorithms/backprojection/general algorithms/backprojection/invariant " \
                "algorithms/backprojection/factorised algorithms/range_migration algorithms/range_migration/delay " \
                "algorithms/wavenumber algorithms/methods harness/text harness/files " \
                "harness/echoes harness/convert harness/scene harness/metrics harness/guests harness/imaging harness/conformance harness/choice harness/results harness/measure harness/show " \
                "harness/report harness/sweep harness/advise harness/ranks harness/run harness/bench harness/stability harness/gate " \
                "harness/papers harness/claims harness/library harness/command harness/tests " \
                "harness/tests/algorithms harness/tests/echoes harness/tests/scene harness/tests/metrics " \
                "harness/tests/imaging harness/tests/results harness/tests/measure harness/tests/show harness/tests/report " \
                "harness/tests/sweep harness/tests/advise harness/tests/run harness/tests/bench harness/tests/stability harness/tests/gate " \
                "harness/tests/claims harness/tests/library harness/tests/command harness/tests/fuzz harness/tests/digits"
        count = split(order, folder, " ")
        for (k = 1; k <= count; k++)
            rank[folder[k]] = k
        # Neighbours that must not know each other.
        apart["algorithms/backprojection/general", "algorithms/backprojection/invariant"] = 1
        apart["algorithms/backprojection/factorised", "algorithms/backprojection/invariant"] = 1
        apart["algorithms/backprojection/factorised", "algorithms/range_migration"] = 1
        apart["algorithms/backprojection/factorised", "algorithms/range_migration/delay"] = 1
        apart["algorithms/backprojection/factorised", "algorithms/wavenumber"] = 1
        apart["algorithms/backprojection", "algorithms/range_migration"] = 1
        apart["algorithms/backprojection/general", "algorithms/range_migration"] = 1
        apart["algorithms/backprojection/invariant", "algorithms/range_migration"] = 1
        apart["algorithms/backprojection", "algorithms/range_migration/delay"] = 1
        apart["algorithms/backprojection/general", "algorithms/range_migration/delay"] = 1
        apart["algorithms/backprojection/invariant", "algorithms/range_migration/delay"] = 1
        apart["algorithms/backprojection/general", "algorithms/wavenumber"] = 1
        apart["algorithms/backprojection/invariant", "algorithms/wavenumber"] = 1
    }
    FNR == 1 && FILENAME !~ /^harness.tests/ {
        held[place(FILENAME)]++
        name = FILENAME
        sub(".*/", "", name)
        stem = substr(name, 1, length(name) - 2)
        if (stem in home && home[stem] != place(FILENAME)) {
            print FILENAME ": " home[stem] " has a file of that name"
            faults++
        }
        home[stem] = place(FILENAME)
    }
    /^#include "/ {
        split($0, part, "\"")
        own = place(FILENAME)
        if (!(own in rank)) {
            print FILENAME ": its folder is not in the order of tests/include_order.sh"
            faults++
            next
        }
        if ((getline line < ("algorithms/" part[2])) >= 0)
            path = "algorithms/" part[2]
        else if ((getline line < ("harness/" part[2])) >= 0)
            path = "harness/" part[2]
        else if ((getline line < (own "/" part[2])) >= 0)
            path = own "/" part[2]
        else
            next                        # made by the build
        close(path)
        other = place(path)
        read++
        if (rank[other] > rank[own] || apart[other, own] || apart[own, other]) {
            printf "%s:%d: includes \"%s\", which comes after %s\n", FILENAME, FNR, part[2], own
            faults++
        }
    }
    END {
        for (k in held)
            if (held[k] > 30) {
                print k ": holds " held[k] " files, at most 30"
                faults++
            }
        if (read < 100) {
            print "only " read + 0 " includes read: is this the source?"
            faults++
        }
        printf "%d includes, %d against the order\n", read, faults
        exit faults > 0
    }'
