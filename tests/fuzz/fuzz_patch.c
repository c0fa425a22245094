/* A patch from bytes: read or refused with a reason; what was read is written as a text that is
 * read as the same patch, can be laid on a face, and gives finite values whatever its channels say.
 */
#include "fuzz_text.h"

#include "stage/perform/patch_bay.h"
#include "stage/perform/patch_file.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void require(bool holds, const char *what)
{
    if (holds)
        return;
    (void)fprintf(stderr, "not so: %s\n", what);
    abort();
}

static void check_values(const patch *p)
{
    static const mrt_channel channels[3] = {{"c", "", MRT_CH_OTHER, MRT_NO_HAND, 0, 1},
                                            {"c", "", MRT_CH_OTHER, MRT_NO_HAND, -1, 1},
                                            {"c", "", MRT_CH_OTHER, MRT_NO_HAND, 0, 0}};
    static const double raw[] = {-1e6, -1.0, -1e-30, 0.0, 0.5, 1.0, 3e38};
    static const patch_range range = {-1.0, 2.0, 0.0};
    for (uint32_t i = 0; i < p->count; ++i)
        for (int k = 0; k < 3; ++k) {
            patch_course course = {0};
            for (size_t r = 0; r < sizeof raw / sizeof *raw; ++r) {
                double wanted = patch_wanted(&p->connection[i], &channels[k], raw[r], &range);
                require(isfinite(wanted), "what is wanted is finite");
                (void)patch_course_step(&course, &p->connection[i], wanted, 0.5, &range, 0.01);
                require(isfinite(course.value), "so is the value");
            }
        }
}

static void check_plan(const patch *p)
{
    static const mrt_contact contacts[2] = {{"mouth.corner.l", "skull", {30, 0, 0}, {0, 0, 1}},
                                            {"mouth.corner.r", "skull", {-30, 0, 0}, {0, 0, 1}}};
    static const mrt_dof dofs[1] = {{"jaw.open", "rad", 0, 0.5f}};
    const mrt_face about = {contacts, dofs, 2, 1, {-80, -120, -80}, {80, 120, 80}};
    patch_plan *plan;
    error err = {""};
    require(patch_plan_create(&plan, p, &about, NULL, NULL, &err) >= 0,
            "what was read can be planned");
    patch_plan_destroy(plan);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static patch p, again;
    error err = {""};
    char *text;
    if (patch_file_parse(&p, (const char *)data, size, "fuzz", &err) < 0) {
        require(fuzz_is_reason(err.text), "one line of reason");
        require(p.count == 0, "nothing is left on failure");
        return 0;
    }
    require(patch_file_write(&text, &p, &err) >= 0, "what was read can be written");
    require(patch_file_parse(&again, text, strlen(text), "again", &err) >= 0 &&
                patch_equal(&p, &again),
            "what was written is read as the same");
    free(text);
    check_values(&p);
    check_plan(&p);
    return 0;
}
