#include "window/gui/ui_damage.hpp"

#include <cmath>
#include <cstdlib>
#include <cstring>
#include <new>

namespace
{

struct kept_list {
    ImGuiID owner = 0;
    ImVector<ImDrawVert> vertex;
    ImVector<ImDrawIdx> index;
    ImVector<ImDrawCmd> command;
};

/* A draw list, of this frame or of the one that is kept. */
struct list_view {
    ImGuiID owner;
    const ImDrawVert *vertex;
    int vertex_count;
    const ImDrawIdx *index;
    const ImDrawCmd *command;
    int command_count;
};

/* The vertices that differ: those between what begins alike and what ends alike. */
struct span {
    int first, end;
};

/* Along the triangles of a list. */
struct triangles {
    const list_view *of;
    span changed;
    int command = 0;
    unsigned int done = 0; /* indices of that command */
};

} // namespace

struct ui_damage {
    bool is_known = false;
    ImVec2 size;
    ImVector<kept_list *> list; /* more than are used */
    int list_count = 0;
    ui_damage_images images = {};
};

/* ---- boxes ---- */

static bool meet(const ImRect &a, const ImRect &b)
{
    return a.Min.x < b.Max.x && b.Min.x < a.Max.x && a.Min.y < b.Max.y && b.Min.y < a.Max.y;
}

static ImRect both(const ImRect &a, const ImRect &b)
{
    ImRect out = a;
    out.Add(b);
    return out;
}

static int cheapest(const ui_damage_boxes *boxes, const ImRect &with)
{
    int best = 0;
    float least = FLT_MAX;
    for (int i = 0; i < boxes->count; ++i) {
        const float more = both(boxes->box[i], with).GetArea() - boxes->box[i].GetArea();
        if (more < least) {
            least = more;
            best = i;
        }
    }
    return best;
}

/* A box that meets others is joined with them, as is one too many. */
static void add_box(ui_damage_boxes *to, ImRect box, ImVec2 size)
{
    box.Min = ImVec2(ImMax(std::floor(box.Min.x) - 1.0f, 0.0f),
                     ImMax(std::floor(box.Min.y) - 1.0f, 0.0f));
    box.Max = ImVec2(ImMin(std::ceil(box.Max.x) + 1.0f, size.x),
                     ImMin(std::ceil(box.Max.y) + 1.0f, size.y));
    if (box.Max.x <= box.Min.x || box.Max.y <= box.Min.y)
        return;
    for (;;) {
        int with = 0;
        while (with < to->count && !meet(to->box[with], box))
            ++with;
        if (with == to->count && to->count < UI_DAMAGE_BOXES) {
            to->box[to->count++] = box;
            return;
        }
        if (with == to->count)
            with = cheapest(to, box);
        box = both(to->box[with], box);
        to->box[with] = to->box[--to->count];
    }
}

static void grow(ImRect *box, ImVec2 low, ImVec2 high, const ImVec4 &clip)
{
    const ImRect seen(ImVec2(ImMax(low.x, clip.x), ImMax(low.y, clip.y)),
                      ImVec2(ImMin(high.x, clip.z), ImMin(high.y, clip.w)));
    if (seen.Min.x < seen.Max.x && seen.Min.y < seen.Max.y)
        box->Add(seen);
}

static ImRect nothing()
{
    return ImRect(FLT_MAX, FLT_MAX, -FLT_MAX, -FLT_MAX);
}

static void grow_triangle(ImRect *box, const list_view *of, const int corner[3], const ImVec4 &clip)
{
    ImVec2 low = of->vertex[corner[0]].pos, high = low;
    for (int i = 1; i < 3; ++i) {
        low = ImMin(low, of->vertex[corner[i]].pos);
        high = ImMax(high, of->vertex[corner[i]].pos);
    }
    grow(box, low, high, clip);
}

/* ---- lists ---- */

static list_view view_of(const ImDrawList *list)
{
    return {ImHashStr(list->_OwnerName ? list->_OwnerName : ""),
            list->VtxBuffer.Data,
            list->VtxBuffer.Size,
            list->IdxBuffer.Data,
            list->CmdBuffer.Data,
            list->CmdBuffer.Size};
}

static list_view view_of(const kept_list *list)
{
    return {list->owner,      list->vertex.Data,  list->vertex.Size,
            list->index.Data, list->command.Data, list->command.Size};
}

/* The next triangle; false: the list has ended. */
static bool next(triangles *self, int corner[3], const ImDrawCmd **out)
{
    const list_view *of = self->of;
    while (self->command < of->command_count &&
           self->done + 3 > of->command[self->command].ElemCount) {
        self->command += 1;
        self->done = 0;
    }
    if (self->command == of->command_count)
        return false;
    const ImDrawCmd *command = &of->command[self->command];
    for (int i = 0; i < 3; ++i)
        corner[i] = static_cast<int>(
            command->VtxOffset +
            of->index[command->IdxOffset + self->done + static_cast<unsigned int>(i)]);
    self->done += 3;
    *out = command;
    return true;
}

/* The next one without a vertex that differs; those that have one are in the box. */
static bool next_alike(triangles *self, int corner[3], const ImDrawCmd **out, ImRect *box)
{
    while (next(self, corner, out)) {
        bool is_alike = true;
        for (int i = 0; i < 3; ++i)
            is_alike &= corner[i] < self->changed.first || corner[i] >= self->changed.end;
        if (is_alike)
            return true;
        grow_triangle(box, self->of, corner, (*out)->ClipRect);
    }
    return false;
}

static ImRect all_of(const list_view *of)
{
    ImRect box = nothing();
    triangles at = {of, {0, 0}};
    int corner[3];
    const ImDrawCmd *command;
    while (next(&at, corner, &command))
        grow_triangle(&box, of, corner, command->ClipRect);
    return box;
}

static bool is_same_way(const ImDrawCmd *a, const ImDrawCmd *b)
{
    return std::memcmp(&a->ClipRect, &b->ClipRect, sizeof a->ClipRect) == 0 &&
           a->TextureId == b->TextureId && !a->UserCallback && !b->UserCallback;
}

static bool is_same_vertex(const ImDrawVert *a, const ImDrawVert *b)
{
    return std::memcmp(a, b, sizeof *a) == 0;
}

/* What differs between two states of a list. */
static ImRect difference(const list_view *before, const list_view *now)
{
    int first = 0, behind = 0;
    const int least = ImMin(before->vertex_count, now->vertex_count);
    while (first < least && is_same_vertex(&before->vertex[first], &now->vertex[first]))
        ++first;
    while (behind < least - first &&
           is_same_vertex(&before->vertex[before->vertex_count - 1 - behind],
                          &now->vertex[now->vertex_count - 1 - behind]))
        ++behind;
    triangles old_at = {before, {first, before->vertex_count - behind}};
    triangles new_at = {now, {first, now->vertex_count - behind}};
    const int shift = now->vertex_count - before->vertex_count;
    ImRect box = nothing();
    for (;;) {
        int old_corner[3], new_corner[3];
        const ImDrawCmd *old_command = nullptr, *new_command = nullptr;
        const bool has_old = next_alike(&old_at, old_corner, &old_command, &box);
        const bool has_new = next_alike(&new_at, new_corner, &new_command, &box);
        if (!has_old && !has_new)
            return box;
        bool is_same = has_old && has_new && is_same_way(old_command, new_command);
        for (int i = 0; i < 3 && is_same; ++i)
            is_same = new_corner[i] == old_corner[i] + (old_corner[i] < first ? 0 : shift);
        if (!is_same) /* equal triangles in another order, or clipped differently */
            return both(all_of(before), all_of(now));
    }
}

static void add_difference(ui_damage_boxes *to, const list_view *before, const list_view *now,
                           ImVec2 size)
{
    const ImRect box = difference(before, now);
    if (box.Min.x < box.Max.x)
        add_box(to, box, size);
}

static void add_list(ui_damage_boxes *to, const list_view *of, ImVec2 size)
{
    const ImRect box = all_of(of);
    if (box.Min.x < box.Max.x)
        add_box(to, box, size);
}

/* ---- images ---- */

static bool is_same_image(const ui_damage_images *kept, const ui_damage_image *now)
{
    for (int i = 0; i < kept->count && i < UI_DAMAGE_IMAGES; ++i)
        if (kept->of[i].texture == now->texture)
            return kept->of[i].version == now->version;
    return false;
}

static void add_image(ui_damage_boxes *to, const ImDrawData *now, ImTextureID texture)
{
    for (int i = 0; i < now->CmdListsCount; ++i) {
        const list_view of = view_of(now->CmdLists[i]);
        triangles at = {&of, {0, 0}};
        ImRect box = nothing();
        int corner[3];
        const ImDrawCmd *command;
        while (next(&at, corner, &command))
            if (command->TextureId == texture)
                grow_triangle(&box, &of, corner, command->ClipRect);
        if (box.Min.x < box.Max.x)
            add_box(to, box, now->DisplaySize);
    }
}

/* ---- for ui.cpp ---- */

ui_damage *ui_damage_create()
{
    return new (std::nothrow) ui_damage;
}

void ui_damage_destroy(ui_damage *self)
{
    if (!self)
        return;
    for (kept_list *list : self->list)
        delete list;
    delete self;
}

void ui_damage_forget(ui_damage *self)
{
    self->is_known = false;
}

static bool is_same_order(const ui_damage *self, const ImDrawData *now)
{
    int at = 0; /* those that both have come in the same order */
    for (int i = 0; i < now->CmdListsCount; ++i) {
        const ImGuiID owner = view_of(now->CmdLists[i]).owner;
        int found = 0;
        while (found < self->list_count && self->list[found]->owner != owner)
            ++found;
        if (found == self->list_count)
            continue;
        if (found < at)
            return false;
        at = found + 1;
    }
    return true;
}

ui_damage_boxes ui_damage_find(const ui_damage *self, const ImDrawData *now,
                               const ui_damage_images *images)
{
    ui_damage_boxes out = {};
    const ImVec2 size = now->DisplaySize;
    if (!self->is_known || size.x != self->size.x || size.y != self->size.y ||
        images->count > UI_DAMAGE_IMAGES || !is_same_order(self, now)) {
        add_box(&out, ImRect(ImVec2(0.0f, 0.0f), size), size);
        return out;
    }
    int at = 0;
    for (int i = 0; i < now->CmdListsCount; ++i) {
        const list_view of = view_of(now->CmdLists[i]);
        int found = at;
        while (found < self->list_count && self->list[found]->owner != of.owner)
            ++found;
        if (found == self->list_count) { /* a menu was opened */
            add_list(&out, &of, size);
            continue;
        }
        for (; at < found; ++at) { /* one was closed */
            const list_view gone = view_of(self->list[at]);
            add_list(&out, &gone, size);
        }
        const list_view before = view_of(self->list[at++]);
        add_difference(&out, &before, &of, size);
    }
    for (; at < self->list_count; ++at) {
        const list_view gone = view_of(self->list[at]);
        add_list(&out, &gone, size);
    }
    for (int i = 0; i < images->count; ++i)
        if (!is_same_image(&self->images, &images->of[i]))
            add_image(&out, now, images->of[i].texture);
    return out;
}

template <typename item> static void copy(ImVector<item> *to, const ImVector<item> &from)
{
    to->resize(from.Size);
    if (from.Size > 0)
        std::memcpy(to->Data, from.Data, static_cast<size_t>(from.Size) * sizeof(item));
}

void ui_damage_keep(ui_damage *self, const ImDrawData *now, const ui_damage_images *images)
{
    self->is_known = false;
    while (self->list.Size < now->CmdListsCount) {
        kept_list *made = new (std::nothrow) kept_list;
        if (!made)
            return; /* all of the next frame is drawn */
        self->list.push_back(made);
    }
    for (int i = 0; i < now->CmdListsCount; ++i) {
        const ImDrawList *from = now->CmdLists[i];
        kept_list *to = self->list[i];
        to->owner = view_of(from).owner;
        copy(&to->vertex, from->VtxBuffer);
        copy(&to->index, from->IdxBuffer);
        copy(&to->command, from->CmdBuffer);
    }
    self->list_count = now->CmdListsCount;
    self->size = now->DisplaySize;
    self->images = *images;
    self->is_known = true;
}
