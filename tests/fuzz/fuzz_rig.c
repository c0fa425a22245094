/* A rig from bytes: whatever they are, they are read or refused with a reason, and what was read
 * can be laid on a mesh or is refused with a reason. */
#include "fuzz_rig.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    rig r;
    error err = {""};
    const clock_t start = clock();
    if (rig_parse(&r, data, size, "fuzz", &err) < 0) {
        require(fuzz_is_reason(err.text), "one line of reason");
        require(!r.document && !r.bone && !r.note, "nothing is left on failure");
        return 0;
    }
    check_indices(&r);
    check_names(&r);
    check_use(&r);
    rig_destroy(&r);
    fuzz_require_quick(start);
    return 0;
}
