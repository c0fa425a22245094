/* Any bytes are a table of curves or are refused with a reason; no table is larger than its text.
 */
#include "fuzz_text.h"
#include "io/curves.h"

#include <assert.h>
#include <math.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    curve_table t;
    error err = {""};
    if (curve_table_parse(&t, data, size, "t.csv", &err) < 0) {
        assert(fuzz_is_reason(err.text) && !t.name && !t.value);
        return 0;
    }
    assert(t.column_count > 0 && t.row_count > 0 && fuzz_is_shown(t.timecode));
    assert((size_t)t.row_count * t.column_count <= size + t.row_count);
    for (uint32_t i = 0; i < t.column_count; ++i) {
        assert(fuzz_is_shown(t.name[i]) && t.bad_row[i] <= t.row_count);
        assert(!t.name[i][0] || curve_table_find(&t, t.name[i]) == i);
    }
    for (size_t i = 0; i < (size_t)t.row_count * t.column_count; ++i)
        assert(!isinf(t.value[i]));
    curve_table_finish(&t);
    return 0;
}
