/* Any bytes as a scene file: loaded, or refused with a message. */
#include "scene/scene.h"
#include "tests/fuzz/input.h"

/* libconfig loses the text of a string at which an error ends its reading. */
const char *__lsan_default_suppressions(void);
const char *__lsan_default_suppressions(void)
{
    return "leak:strbuf_append\nleak:libconfig_yylex";
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct scene scene;
    enum status status = scene_load(fuzz_file(0, "fuzz.cfg", data, size), SASBENCH_ROOT "/scenes", &scene);
    if (status == STATUS_OK)
        scene_free(&scene);
    else if (!*status_message())
        fuzz_fail("refused without a message");
    return 0;
}
