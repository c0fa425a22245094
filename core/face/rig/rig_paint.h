/* face/rig_paint.h - what was painted: "paints": { "jaw": ["120-180:ff", "204:0c1f33"] }, in the
 * rig file and as ranges of a selector. Values are 255ths, two digits 0-9a-f each: of all vertices
 * of a range, or of those that follow one. Inside the room. [any] */
#ifndef MAROTTE_FACE_RIG_PAINT_H
#define MAROTTE_FACE_RIG_PAINT_H
#include "base/budget.h"
#include "face/rig.h"
#include "face/rig/rig_document.h"

/* Out of the budget (NULL: it was read before) fills first, last, value, range_count; neighbours of
 * one value are one range, 0 is left away. */
CHECKED mrt_result rig_paint_parse(rig_select *out, const json_node *at, budget *b, error *err);
json_t *rig_paint_to_json(const rig_select *select); /* NULL: no memory */
bool rig_paint_equals(const rig_select *a, const rig_select *b);
/* Of a dense array; what was there is freed. */
CHECKED mrt_result rig_paint_set(rig_select *out, const uint8_t *value, uint32_t vertex_count,
                                 error *err);
void rig_select_free_ranges(rig_select *select); /* of either kind */

#endif
