/* Links in a folder of results: whoever may write there must not make us write elsewhere. The program's path is in the
   environment variable SASBENCH_PROGRAM. */
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/support.h"

#include "files/folder.h"
#include "files/text_file.h"

/* Commands that write into the folder r, as the clean one leaves it: all names there become links, to a file, a folder
   and nothing in turn. What is read is refused as a link. */
#define THREE "-a bp_zeropad:factor=2 -a bp_zeropad:factor=4 -a bp_zeropad:factor=8" /* a series that is drawn */

static const struct writer {
    const char *first, *again; /* a command; NULL: the first */
    bool keeps;                /* its measurements stay for the command again */
    int turns;                 /* of the kinds of links: 3, or less where it takes long */
} writers[] = {
    {"run study/quick -a bp_nearest -a auto -o r", NULL, false, 1},
    {"run study/quick " THREE " -o r", "report r", true, 1},
    {"sweep scene.cfg " THREE " -o r", NULL, false, 1},
    {"sweep scene.cfg " THREE " -o r", "report r", true, 3},
    {"phase study/quick -o r", NULL, false, 3},
    {"stability extreme/M1 -a bp_nearest --quick -o r", NULL, false, 3},
    {"reproduce zp15_f3 -o r", NULL, false, 1},
};

#define STATE "find victims -printf '%p %i %m %s %T@ %y\\n' | sort"

static void links_plant(int turn, const char *but)
{
    char line[2000];
    snprintf(line, sizeof line,
             "rm -rf r victims; cp -a clean r; mkdir victims; k=%d\n"
             "for f in $(cd clean; find . -type f %s); do k=$((k + 1)); v=\"$PWD/victims/$k\"\n"
             "case $((k %% 3)) in 0) echo mine > $v;; 1) mkdir $v;; esac; ln -sf $v r/$f; done\n%s > before",
             turn, but, STATE);
    assert_shell(line, 0);
}

/* Nothing but the folder's own names is written; `wanted` of the exit status. */
static void victims_check(const struct writer *writer, bool refused)
{
    char line[500];
    const char *command = writer->again ? writer->again : writer->first;
    snprintf(line, sizeof line, "timeout 300 \"$SASBENCH_PROGRAM\" %s", command);
    assert_shell("rm -f err", 0);
    int status = support_shell(line);
    if (support_shell(STATE " | cmp before -") != 0)
        fail_msg("%s wrote through a link", command);
    char *said = support_read("err");
    if (status != (refused ? 2 : 0))
        fail_msg("%s among links exits with %d, says: %s", command, status, said ? said : "");
    if (refused && !strstr(said, "a symbolic link, which is not followed"))
        fail_msg("%s among links says: %s", command, said);
    free(said);
}

static void writers_follow_no_link(void **state)
{
    (void)state;
    for (size_t k = 0; k < sizeof writers / sizeof *writers; k++) {
        const struct writer *writer = &writers[k];
        const bool reads = !strstr(writer->first, "phase") && !strstr(writer->first, "stability");
        char line[500];
        snprintf(line, sizeof line, "rm -rf r clean; \"$SASBENCH_PROGRAM\" %s", writer->first);
        assert_shell(line, 0);
        snprintf(line, sizeof line, "\"$SASBENCH_PROGRAM\" %s; mv r clean", writer->again ? writer->again : "list");
        assert_shell(line, 0);
        links_plant(0, "");
        victims_check(writer, reads);
        for (int turn = 0; turn < writer->turns; turn++) {
            links_plant(turn, writer->keeps ? "! -name measurements.csv ! -name 'pred*.csv'"
                                            : "! -name measurements.csv ! -name targets.csv ! -name plans.csv");
            if (!writer->keeps)
                assert_shell("rm -f r/measurements.csv r/targets.csv r/plans.csv", 0);
            victims_check(writer, false);
            if (!writer->keeps)
                assert_shell("! find r -type l | grep .", 0);
        }
    }
}

/* While reports are written, their names become links again and again. */
static void links_made_meanwhile(void **state)
{
    (void)state;
    assert_shell("\"$SASBENCH_PROGRAM\" run study/quick -a bp_nearest -o r && \"$SASBENCH_PROGRAM\" report r", 0);
    assert_shell("mkdir victims; echo mine > victims/1; " STATE " > before", 0);
    assert_shell(
        "{ while ! [ -e stop ]; do for f in report.html; do ln -sf ../victims/1 r/$f; ln -s "
        "../victims/2 r/$f; rm -f r/$f; done; done; } & "
        "for k in 1 2 3 4 5; do \"$SASBENCH_PROGRAM\" report r || touch bad; done; touch stop; wait; ! [ -e bad ]",
        0);
    assert_shell(STATE " | cmp before -", 0);
}

/* What the user names is another matter; what `show` names itself is not. */
static void show_follows_what_is_named(void **state)
{
    (void)state;
    assert_shell("echo mine > victim; \"$SASBENCH_PROGRAM\" image --scene study/quick -a bp_nearest -o x.mat", 0);
    assert_shell("ln -s victim x.png; ln -s victim named.png; \"$SASBENCH_PROGRAM\" show x.mat", 0);
    assert_shell("test \"$(cat victim)\" = mine && ! [ -L x.png ]", 0);
    assert_shell("\"$SASBENCH_PROGRAM\" show x.mat -o named.png && [ -L named.png ] && tail -c 8 victim | grep -q IEND",
                 0);
    assert_shell("\"$SASBENCH_PROGRAM\" image --scene study/quick -a bp_nearest -o named.png && [ -L named.png ]", 0);
}

static void text_put(const char *path, const char *text)
{
    struct text_file file;
    if (text_file_open(path, &file) != STATUS_OK)
        fail_msg("%s", status_message());
    fputs(text, file.stream);
    if (text_file_close(&file, STATUS_OK) != STATUS_OK)
        fail_msg("%s", status_message());
}

/* A folder that is taken stays the same one, also when another stands under its name. */
static void taken_folders_are_held(void **state)
{
    (void)state;
    int lock;
    char path[900], below[600];
    snprintf(path, sizeof path, "%s/a.csv", path_of("r"));
    snprintf(below, sizeof below, "%s/below", path_of("r"));
    assert_shell("mkdir r victims", 0);
    assert_int_equal(folder_take(path_of("r"), &lock), STATUS_OK);
    assert_shell("mv r old; ln -s victims r", 0);
    text_put(path, "a\n");
    assert_int_equal(directory_make(below), STATUS_OK);
    assert_shell("test \"$(cat old/a.csv)\" = a && test -d old/below && ! ls victims | grep .", 0);
    snprintf(path, sizeof path, "%s/b.csv", below);
    text_put(path, "b\n");
    assert_shell("test \"$(cat old/below/b.csv)\" = b", 0);

    /* A folder in it that is a link is none. */
    struct text_file file;
    int inner;
    assert_shell("rm -r old/below; ln -s \"$PWD/victims\" old/below", 0);
    assert_int_equal(text_file_open(path, &file), STATUS_INVALID);
    assert_int_equal(folder_take(below, &inner), STATUS_INVALID);
    assert_int_equal(inner, -1);
    assert_shell("! ls victims | grep .", 0);

    /* Reading follows none, either. */
    snprintf(path, sizeof path, "%s/c.csv", path_of("r"));
    assert_shell("echo secret > victims/c; ln -s ../victims/c old/c.csv", 0);
    assert_int_equal(place_read(path, 0), -1);
    assert_int_equal(errno, ELOOP);
    folder_leave(lock);
}

/* What is in the way of a name, and folders that are no place for results. */
static void places_that_are_none(void **state)
{
    (void)state;
    struct text_file file;
    int lock;
    char path[600];
    assert_shell("mkdir r r/a.csv shared other; mkfifo r/b.csv; chmod 1777 shared", 0);
    snprintf(path, sizeof path, "%s/a.csv", path_of("r"));
    assert_int_equal(text_file_open(path, &file), STATUS_INVALID);
    assert_non_null(strstr(status_message(), "Is a directory"));
    snprintf(path, sizeof path, "%s/b.csv", path_of("r"));
    const int reader = open(path, O_RDWR | O_CLOEXEC); /* so that writing into it would not wait for one */
    text_put(path, "b\n");
    close(reader);
    assert_shell("test -f r/b.csv", 0);
    assert_int_equal(folder_take(path_of("shared"), &lock), STATUS_INVALID);
    assert_non_null(strstr(status_message(), "all users share this folder"));
    assert_int_equal(lock, -1);
    if (geteuid() != 0)
        return; /* only root can give a folder away, and be another user */
    static const struct {
        uid_t owner;
        gid_t group;
        mode_t mode;
        enum status status;
    } folders[] = {
        {65533, 65533, 0777, STATUS_INVALID}, {65533, 65534, 0775, STATUS_OK}, {65533, 65534, 0757, STATUS_INVALID},
        {65534, 65533, 0700, STATUS_OK},      {0, 0, 0777, STATUS_OK},
    };
    assert_int_equal(chmod(folder, 0755), 0);
    for (size_t k = 0; k < sizeof folders / sizeof *folders; k++) {
        assert_int_equal(chown(path_of("other"), folders[k].owner, folders[k].group), 0);
        assert_int_equal(chmod(path_of("other"), folders[k].mode), 0);
        assert_int_equal(setegid(65534), 0);
        assert_int_equal(seteuid(65534), 0);
        enum status status = folder_take(path_of("other"), &lock);
        folder_leave(lock);
        assert_int_equal(seteuid(0), 0);
        assert_int_equal(setegid(0), 0);
        if (status != folders[k].status)
            fail_msg("folder %zu: %d, %s", k, status, status_message());
    }
    assert_int_equal(chown(path_of("other"), 65533, 65533), 0);
    assert_int_equal(folder_take(path_of("other"), &lock), STATUS_OK); /* root, as in a container */
    folder_leave(lock);
}

static int links_make(void **state)
{
    if (folder_make(state) != 0)
        return -1;
    support_write("scene.cfg", "");
    return support_shell("cp \"$ROOT/scenes/study/quick.cfg\" scene.cfg");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(taken_folders_are_held, links_make, folder_remove),
        cmocka_unit_test_setup_teardown(places_that_are_none, links_make, folder_remove),
        cmocka_unit_test_setup_teardown(show_follows_what_is_named, links_make, folder_remove),
        cmocka_unit_test_setup_teardown(links_made_meanwhile, links_make, folder_remove),
        cmocka_unit_test_setup_teardown(writers_follow_no_link, links_make, folder_remove),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
