/* window/gui/ui_notes.h - records the text of a frame and its background, for tests that search for
 * overlapping, cut or unreadable text. Off by default. Uses only its own memory; one thread. */
#ifndef MAROTTE_UI_WINDOW_GUI_UI_NOTES_H
#define MAROTTE_UI_WINDOW_GUI_UI_NOTES_H
#include "window/gui/ui_types.h"

typedef struct ui_notes ui_notes;

ui_notes *ui_notes_create(void); /* NULL: no memory */
void ui_notes_destroy(ui_notes *self);
void ui_notes_set(ui_notes *self, bool is_noting);
bool ui_notes_is_on(const ui_notes *self);
void ui_notes_begin(ui_notes *self); /* a frame */

/* Adds a surface. Later ones cover earlier ones, and popups cover all panels. Returns its number.
 */
uint32_t ui_notes_surface(ui_notes *self, ui_rectangle where, bool is_popup);
/* A box of one colour; alpha 0: a picture, of which nobody knows the colour. */
void ui_notes_box(ui_notes *self, uint32_t surface, ui_rectangle where, uint32_t colour);
/* word->ground is found; the text is copied. */
void ui_notes_word(ui_notes *self, uint32_t surface, const ui_word *word);
/* A widget; the hint that comes next is its own, unless ui_notes_other comes before. */
void ui_notes_control(ui_notes *self, const char *label);
void ui_notes_other(ui_notes *self);
void ui_notes_hint(ui_notes *self);
uint32_t ui_notes_controls(const ui_notes *self, const ui_control **out);
/* Removes text that a popup hides. */
void ui_notes_end(ui_notes *self);
uint32_t ui_notes_words(const ui_notes *self, const ui_word **out);

#endif
