# One scene of a results folder as gnuplot commands: formats points.csv, which `sweep` and `report` write, and, where they
# are, the other tables of `sweep`; nothing is judged here. plots/folder.gp runs it; FOLDER and SCENE are taken from the environment, since -v would interpret them.
#
# Without SCENE it prints the array scenes[]. With it:
#   caption                        scene, machine, threads and commit
#   $rows                          a block for each series, sorted by its setting, of the lines
#                                  rate run_s flops error pslr islr "label" "label" low high   (rate: samples for each one recorded,
#                                  NaN where nothing is upsampled; the setting's value where it is to be written beside
#                                  the point over run_s, over flops: sparsely, so that no two overlap; low, high: the
#                                  quartiles of run_s)
#   series[], family[], member[], precise[]   title; the algorithm's number in families.gp; which of its series; 1 for double
#   rated[]                        the numbers of the series whose rows have a rate
#   $control                       the scalar reference loop's time: two lines of run_s error, from the largest error to the least
#   reference_pslr, reference_islr NaN where unknown
#   has_points, has_lobes, has_rates   1 where there is something to draw: a series of three points; with it lobes beside
#                                  the reference's; three points with an upsampling rate, one of them above 1
#   $front_run_s, $front_flops     lines: cost error
#   $slopes, $slope_labels         lines: rate error, two for each straight line, with two empty lines after; rate error
#                                  "label"; has_slopes: 1 where there are any
#   has_rules, bp22_rate, zp15_rate, edge_phase, linear_floor     0 or 1; NaN where unknown
#
# Rows whose image is smaller than the others' (exact ones) are no points.
#
# What is printed is run by gnuplot, and the folder may come from anywhere: no sign of its texts is printed as it is. Numbers are
# printed as they were understood, texts as octal codes.

function quoted(text,    codes, k)
{
    for (k = 1; k <= length(text); k++)
        codes = codes sprintf("\\%03o", code_of[substr(text, k, 1)])
    return "\"" codes "\""
}

function is_number(text)
{
    return text ~ /^[-+]?([0-9]+[.]?[0-9]*|[.][0-9]+)([eE][-+]?[0-9]+)?$/ && text + 0 > -1e300 && text + 0 < 1e300
}

function number(text)
{
    return is_number(text) ? sprintf("%.9g", text) : "NaN"
}

# gnuplot ends with the message.
function refuse(path, place, fault)
{
    print "exit error " quoted(path ":" line_number[path] ":" place ": " fault)
    exit 1
}

# The next line of a CSV file that is no comment into field[NAME]; 0 at its end or where there is no such file. Names are
# those of the first such line. Control characters, and so lines within quotes, are refused.
function row_read(path,    line, text, name, n, end)
{
    do {
        if ((getline line < path) <= 0)
            return 0
        if (++line_number[path] == 1)
            sub(/^\357\273\277/, "", line)              # byte order mark
        sub(/\r$/, "", line)
        if (match(line, /[\001-\037\177]/))
            refuse(path, RSTART, "a control character; text is needed")
        if (line ~ /^#/)
            note_read(line)
    } while (line ~ /^#/ || line == "")
    if (gsub(/"/, "&", line) % 2)
        refuse(path, length(line), "a quoted field does not end in its line")
    for (n = 1; ; n++) {
        if (line ~ /^"/) {
            text = ""
            line = substr(line, 2)
            while ((end = index(line, "\"")) > 0) {
                text = text substr(line, 1, end - 1)
                line = substr(line, end + 1)
                if (line !~ /^"/)
                    break
                text = text "\""
                line = substr(line, 2)
            }
        } else {
            end = index(line, ",")
            text = end ? substr(line, 1, end - 1) : line
            line = end ? substr(line, end) : ""
        }
        if (header[path] < 0)
            field[names[path, n]] = text
        else
            names[path, n] = text
        if (line !~ /^,/)
            break
        line = substr(line, 2)
    }
    if (header[path] < 0)
        return 1
    header[path] = -1
    return row_read(path)
}

function note_read(line)
{
    sub(/^# /, "", line)
    if (line ~ /^[a-z]+: /)
        note[substr(line, 1, index(line, ":") - 1)] = substr(line, index(line, ": ") + 2)
}

# Sorted insertion of a row's line into its series.
function series_add(key, order, line,    at)
{
    for (at = ++length_of[key]; at > 1 && orders[key, at - 1] > order; at--) {
        orders[key, at] = orders[key, at - 1]
        lines[key, at] = lines[key, at - 1]
    }
    orders[key, at] = order
    lines[key, at] = line
}

function point_take(    key, at)
{
    if (field["scene"] != scene || !is_number(field["run_s"]) || !is_number(field["error"]) \
        || !(field["run_s"] + 0 > 0) || !(field["error"] + 0 > 0))
        return
    if (field["algorithm"] == "reference") {
        reference_pslr = field["pslr_db"]
        reference_islr = field["islr_db"]
    }
    key = field["algorithm"] SUBSEP field["rest"] SUBSEP field["precision"]
    if (!(key in length_of)) {
        keys[++key_count] = key
        title_of[key] = field["algorithm"] (field["rest"] == "" ? "" : " " field["rest"])
        algorithm_of[key] = field["algorithm"]
        if (!((field["algorithm"], field["rest"]) in member_of))
            member_of[field["algorithm"], field["rest"]] = ++member_count[field["algorithm"]]
        member_at[key] = member_of[field["algorithm"], field["rest"]]
        precise_at[key] = field["precision"] == "double"
    }
    series_add(key, field["value"] + 0, number(field["rate"]) " " number(field["run_s"]) " " number(field["flops"]) " " \
        number(field["error"]) " " number(field["pslr_db"]) " " number(field["islr_db"]) " " \
        (is_number(field["value"]) ? number(field["value"]) : "-") " " (field["is_point"] == "1") " " \
        (field["front_run_s"] == "1") " " (field["front_flops"] == "1") " " number(field["run_q1_s"]) " " number(field["run_q3_s"]))
    if (!is_number(field["control_s"]))
        return
    for (at = ++control_count; at > 1 && control[at - 1] + 0 > field["control_s"] + 0; at--)
        control[at] = control[at - 1]
    control[at] = number(field["control_s"])
}

# Of all rows measured those that are shown, one after the other: point[n, COLUMN].
function points_collect(    k, at, part)
{
    for (k = 1; k <= key_count; k++)
        for (at = 1; at <= length_of[keys[k]]; at++) {
            split(lines[keys[k], at], part, " ")
            if (!part[8])
                continue
            point[++points, "key"] = k
            point[points, "line"] = part[1] " " part[2] " " part[3] " " part[4] " " part[5] " " part[6]
            point[points, "x", 1] = log(part[2])
            point[points, "x", 2] = log(part[3])
            point[points, "y"] = log(part[4])
            point[points, "label"] = part[7]
            point[points, "front", 1] = part[9]
            point[points, "front", 2] = part[10]
            point[points, "interval"] = part[11] " " part[12]
            lobes += (part[5] != "NaN" && title_of[keys[k]] != "reference")
            if (part[1] != "NaN" && rated[rated_count] != k)
                rated[++rated_count] = k
            rates += (part[1] != "NaN")
            upsampled = upsampled || (part[1] != "NaN" && part[1] + 0 > 1)
        }
}

# Which points in float get a label: those of the Pareto front, then the ends of the series, then the rest, while there is room.
# A label takes about 1/30 of the axis's width and 1/30 of its height.
function labels_place(axis,    n, m, rank, ranks, free, x_least, x_most, y_least, y_most)
{
    x_least = y_least = 1e9
    x_most = y_most = -1e9
    for (n = 1; n <= points; n++) {
        if (point[n, "x", axis] < x_least) x_least = point[n, "x", axis]
        if (point[n, "x", axis] > x_most) x_most = point[n, "x", axis]
        if (point[n, "y"] < y_least) y_least = point[n, "y"]
        if (point[n, "y"] > y_most) y_most = point[n, "y"]
        ranks[n] = precise_at[keys[point[n, "key"]]] ? 4 : point[n, "front", axis] ? 1 \
            : point[n - 1, "key"] != point[n, "key"] || point[n + 1, "key"] != point[n, "key"] ? 2 : 3
    }
    for (rank = 1; rank <= 3; rank++)
        for (n = 1; n <= points; n++) {
            if (ranks[n] != rank)
                continue
            free = point[n, "label"] != "-"
            for (m = 1; m <= points && free; m++)
                if (m != n && (point[m, "shown", axis] || rank == 3) \
                    && far(point[m, "x", axis] - point[n, "x", axis], x_most - x_least) < 1 \
                    && far(point[m, "y"] - point[n, "y"], y_most - y_least) < 1)
                    free = 0
            point[n, "shown", axis] = free
        }
}

# A distance in label sizes.
function far(distance, extent)
{
    return 30*(distance < 0 ? -distance : distance)/(extent > 0 ? extent : 1)
}

function rows_print(    k, n, size, longest, least, most)
{
    points_collect()
    labels_place(1)
    labels_place(2)
    print "$rows << END_OF_ROWS"
    for (k = n = 1; k <= key_count; k++) {
        if (point[n, "key"] != k)
            print "NaN NaN NaN NaN NaN NaN \"\" \"\" NaN NaN"
        for (; point[n, "key"] == k; n++)
            print point[n, "line"], "\"" (point[n, "shown", 1] ? point[n, "label"] : "") "\"",
                "\"" (point[n, "shown", 2] ? point[n, "label"] : "") "\"", point[n, "interval"]
        print "\n"
    }
    print "END_OF_ROWS"
    size = key_count > 0 ? key_count : 1
    print "array series[" size "]; array family[" size "]; array member[" size "]; array precise[" size "]"
    for (k = 1; k <= key_count; k++) {
        printf "series[%d] = %s; family[%d] = family_drawn(%s); ", k, quoted(title_of[keys[k]]), k, quoted(algorithm_of[keys[k]])
        printf "member[%d] = %d; precise[%d] = %d\n", k, member_at[keys[k]], k, precise_at[keys[k]]
    }
    if (rated_count)
        print "array rated[" rated_count "]"
    for (k = 1; k <= rated_count; k++)
        printf "rated[%d] = %d\n", k, rated[k]
    least = 1e9
    most = -1e9
    for (n = 1; n <= points; n++) {
        if (point[n, "y"] < least) least = point[n, "y"]
        if (point[n, "y"] > most) most = point[n, "y"]
    }
    if (control_count && points)
        printf "$control << END_OF_CONTROL\n%s %.9g\n%s %.9g\nEND_OF_CONTROL\n", control[int((control_count + 1)/2)],
            exp(most), control[int((control_count + 1)/2)], exp(least)
    printf "reference_pslr = %s; reference_islr = %s\n", number(reference_pslr), number(reference_islr)
    longest = 0
    for (k = 1; k <= key_count; k++) {
        for (n = size = 0; n <= points; n++)
            size += (point[n, "key"] == k)
        if (size > longest)
            longest = size
    }
    printf "has_points = %d; has_lobes = %d; has_rates = %d\n", (longest >= 3),
        (longest >= 3 && lobes >= 3 && reference_pslr != "" && reference_islr != ""), (rates >= 3 && upsampled)
}

# The Pareto front, the cheapest first.
function front_print(axis, name,    n, at, count, order)
{
    for (n = 1; n <= points; n++)
        if (point[n, "front", axis]) {
            for (at = ++count; at > 1 && point[order[at - 1], "x", axis] > point[n, "x", axis]; at--)
                order[at] = order[at - 1]
            order[at] = n
        }
    printf "$front_%s << END_OF_FRONT\n", name
    for (at = 1; at <= count; at++)
        printf "%.9g %.9g\n", exp(point[order[at], "x", axis]), exp(point[order[at], "y"])
    print "END_OF_FRONT"
}

# Lines through the float series of the upsampling rate, and what is said at their middle.
function slopes_print(    text, ends)
{
    while (row_read(folder "/slopes.csv"))
        if (field["scene"] == scene && (field["setting"] == "beta" || field["setting"] == "factor") \
            && field["part"] != "falling" && field["precision"] == "float" && is_number(field["slope"]) \
            && is_number(field["rate_first"]) && is_number(field["rate_last"]) \
            && is_number(field["error_first"]) && is_number(field["error_last"]) \
            && field["rate_first"]*field["rate_last"] > 0 && field["error_first"]*field["error_last"] > 0) {
            ends = ends sprintf("%s %s\n%s %s\n\n\n", number(field["rate_first"]), number(field["error_first"]),
                number(field["rate_last"]), number(field["error_last"]))
            text = text sprintf("%.9g %.9g \"%sslope %.2f\"\n", sqrt(field["rate_first"]*field["rate_last"]),
                sqrt(field["error_first"]*field["error_last"]), field["part"] == "floor" ? "floor, " : "", field["slope"])
        }
    printf "$slopes << END_OF_SLOPES\n%sEND_OF_SLOPES\n", ends
    printf "$slope_labels << END_OF_LABELS\n%sEND_OF_LABELS\nhas_slopes = %d\n", text, (text != "")
}

function rules_print()
{
    while (row_read(folder "/rules.csv") && field["scene"] != scene)
        ;
    if (field["scene"] != scene)
        split("", field)
    printf "has_rules = %d; bp22_rate = %s; zp15_rate = %s; edge_phase = %s; linear_floor = %s\n",
        (field["scene"] == scene), number(field["bp22_eq20_rate"]), number(field["zp15_rate"]), number(field["edge_phase_rad"]),
        number(field["linear_floor"])
}

BEGIN {
    for (k = 1; k < 256; k++)
        code_of[sprintf("%c", k)] = k
    folder = ENVIRON["FOLDER"]
    scene = ENVIRON["SCENE"]
    while (row_read(folder "/points.csv")) {
        if (!(field["scene"] in seen)) {
            seen[field["scene"]] = 1
            scenes[++scene_count] = field["scene"]
        }
        point_take()
    }
    if (scene == "") {
        print "array scenes[" scene_count "]"
        for (k = 1; k <= scene_count; k++)
            print "scenes[" k "] = " quoted(scenes[k])
    } else {
        print "caption = " quoted(scene ", " note["machine"] ", " note["threads"] " threads, commit " note["commit"])
        rows_print()
        front_print(1, "run_s")
        front_print(2, "flops")
        split("", field)
        slopes_print()
        split("", field)
        rules_print()
    }
}
