#include "face/rig_edit.h"

#include "face/rig/rig_document.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

typedef struct words {
    char *at;
    size_t capacity;
} words;

__attribute__((format(printf, 2, 3))) static void say(words *w, const char *format, ...)
{
    size_t used = strlen(w->at);
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(w->at + used, w->capacity - used, format, arguments);
    va_end(arguments);
}

static uint32_t vertex_count_of(const rig_select *select)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < select->range_count; ++i)
        count += select->last[i] - select->first[i] + 1;
    return count;
}

static void describe(words *w, const rig_select *select);

static void describe_joined(words *w, const rig_select *select)
{
    const char *between = select->kind == SELECT_ALL ? ", " : " or ";
    for (uint32_t i = 0; i < select->child_count; ++i) {
        bool is_group = select->child[i].kind == SELECT_ALL || select->child[i].kind == SELECT_ANY;
        say(w, "%s%s", i ? between : "", is_group ? "(" : "");
        describe(w, &select->child[i]);
        say(w, "%s", is_group ? ")" : "");
    }
}

static void describe(words *w, const rig_select *select)
{
    switch (select->kind) {
    case SELECT_VERTICES:
        say(w, "%u vertices", vertex_count_of(select));
        break;
    case SELECT_GROUP:
        say(w, "part %s", select->name);
        break;
    case SELECT_ATTRIBUTE:
        say(w, "attribute %s", select->name);
        break;
    case SELECT_BOX:
        say(w, "in a box");
        break;
    case SELECT_ELLIPSOID:
        say(w, "in an ellipsoid");
        break;
    case SELECT_HALF_SPACE:
        say(w, "beyond a plane");
        break;
    case SELECT_WITHIN:
        say(w, "within %.0f mm of vertex %u", select->within_mm, select->vertex);
        break;
    case SELECT_ALL:
    case SELECT_ANY:
        describe_joined(w, select);
        break;
    case SELECT_NOT:
        say(w, "not ");
        describe(w, &select->child[0]);
        break;
    case SELECT_PAINTED:
        say(w, "painted, %u vertices", vertex_count_of(select));
        break;
    case SELECT_NOTHING:
        say(w, "nothing");
        break;
    }
}

void rig_edit_describe(const rig_select *select, char *out, size_t capacity)
{
    words w = {out, capacity};
    out[0] = '\0';
    describe(&w, select);
}

/* ---- from a place in the file ---- */

/* "$.regions[1]" is said by "$.regions[1].select", not by "$.regions[12]". */
static bool says_place(const char *path, const rig_place *place)
{
    size_t length = strlen(place->text);
    return strncmp(path, place->text, length) == 0 &&
           (path[length] == '\0' || path[length] == '.' || path[length] == '[');
}

static bool find_in(const rig *r, rig_section section, uint32_t count, const char *path,
                    uint32_t *out_index)
{
    for (uint32_t i = 0; i < count; ++i) {
        rig_place place = rig_where(r, section, i);
        *out_index = i;
        if (says_place(path, &place))
            return true;
    }
    return false;
}

rig_edit_kind rig_edit_kind_at(const rig *r, const char *path, uint32_t *out_index)
{
    if (find_in(r, RIG_REGIONS, r->region_count, path, out_index))
        return RIG_EDIT_REGION;
    if (find_in(r, RIG_CONTACTS, r->contact_count, path, out_index))
        return RIG_EDIT_CONTACT;
    return find_in(r, RIG_BONES, r->bone_count, path, out_index) ? RIG_EDIT_BONE : RIG_EDIT_OTHER;
}
