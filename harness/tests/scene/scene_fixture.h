/* Scene files made of text, in the folder of a test (support.h). */
#ifndef SASBENCH_TEST_SCENE_FIXTURE_H
#define SASBENCH_TEST_SCENE_FIXTURE_H

#include "scene/scene.h"
#include "tests/support.h"

#define SHIPPED         SASBENCH_ROOT "/scenes"
#define IMAGE           "image = { around_targets = { half_x = 0.2; half_r = 0.1; x_step = 0.02; r_step = 0.025; }; };"
#define NESTED          10 /* includes, at most */
#define COUNT_OF(array) (sizeof array / sizeof *array)

/* One group a line, so that every refusal can be checked for its line. */
extern const char *const base_text;

/* The text as scene.cfg. scene_loaded: the test fails where that fails. */
enum status scene_load_text(const char *text, struct scene *scene);
struct scene scene_loaded(const char *text);
/* base_text with its first `find` replaced; malloc'ed. */
char *scene_varied(const char *find, const char *replace);
uint64_t scene_hash_of(const char *text);
void assert_message_has(const char *part, const char *what);

#endif
