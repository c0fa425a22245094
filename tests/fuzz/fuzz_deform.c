/* A case of control vectors: read or refused with one line that names it, and what was read can be
 * run, or it is said why not. Cases that are long by their own measure (the engine's own time) are
 * read only. */
#include "cli/deform_case.h"
#include "fuzz_text.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void require(bool holds, const char *what)
{
    if (holds)
        return;
    fprintf(stderr, "does not hold: %s\n", what);
    abort();
}

static void check_run(const deform_case *c, deform_precision precision)
{
    error err = {""};
    size_t numbers = (size_t)3 * c->point_count * c->frame_count;
    double *out = calloc(numbers + 1, sizeof *out);
    require(out != NULL, "memory");
    if (deform_case_run(c, precision, out, &err) < 0)
        require(fuzz_is_reason(err.text), "one line of reason");
    else
        for (size_t i = 0; i < numbers; ++i)
            require(isfinite(out[i]), "positions are finite");
    free(out);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    enum { CENTRES_MAX = 64, WORK_MAX = 1 << 14 };
    deform_case c;
    error err = {""};
    if (deform_case_read(&c, data, size, "fuzz.json", &err) < 0) {
        require(strncmp(err.text, "fuzz.json", 9) == 0 && fuzz_is_reason(err.text),
                "one line of reason");
        return 0;
    }
    require(c.tip_count > 0 && c.frame_count > 0 && c.point_count > 0, "a case has something");
    require(fuzz_is_shown(c.unknown), "unknown keys are shown");
    const uint32_t centres = c.tip_count + c.skull_count + c.jaw_count;
    if (centres <= CENTRES_MAX && (uint64_t)centres * c.frame_count * c.point_count <= WORK_MAX) {
        check_run(&c, DEFORM_F64);
        check_run(&c, DEFORM_F32);
    }
    deform_case_destroy(&c);
    return 0;
}
