/* window/export_page.h - which takes are exported, as what and called what; and how far those are
 * that go on. [main] */
#ifndef MAROTTE_UI_WINDOW_EXPORT_PAGE_H
#define MAROTTE_UI_WINDOW_EXPORT_PAGE_H
#include "window/app/app.h"
#include "window/app/exporter.h"
#include "window/app/presets.h"
#include "window/gui/ui.h"

enum { EXPORT_TICKS = 99 };
typedef struct export_page {
    app *app;
    ui *ui;
    uint32_t format, rate, size, view, background; /* of the lists in export_page.c */
    char own_size[24], own_background[EXPORT_FILE];
    char file[EXPORT_FILE]; /* a pattern: show/export_name.h */
    int64_t ticked[EXPORT_TICKS];
    uint32_t ticked_count;
    uint32_t preset; /* 0: none; those that come with it, then those of the settings */
    char preset_name[PRESET_NAME];
    bool only_range, is_asked_first;
    char replaced[EXPORT_FILE]; /* the first of replaced_count existing files that the user was
                                   warned about */
    uint32_t replaced_count;
    error trouble; /* why nothing was exported; "" */
} export_page;

void export_page_init(export_page *out, app *of, ui *on);
/* Each frame, over all panels. */
void export_page_draw(export_page *self);
void export_page_ask(export_page *self);       /* how the chosen take, and others, are exported */
void export_page_ask_going(export_page *self); /* how far they are */
/* Lists running exports with progress and Cancel, inside the dialog of the caller. */
void export_page_list_going(ui *on, app *of);

#endif
