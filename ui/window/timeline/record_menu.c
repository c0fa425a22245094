#include "window/timeline/record_menu.h"

#include <math.h>
#include <stdio.h>

static const double leads_s[] = {0.0, 1.0, 2.0, 3.0, 5.0};
enum { LEADS = sizeof leads_s / sizeof leads_s[0] };

/* Returns true if the choice has changed. */
static bool lead_items(ui *on, const char *what, const char *none, double *s)
{
    const double before_s = *s;
    for (int i = 0; i < LEADS; ++i) {
        char label[64];
        if (leads_s[i] > 0.0)
            (void)snprintf(label, sizeof label, "%s %g s", what, leads_s[i]);
        if (ui_menu_item(on, leads_s[i] > 0.0 ? label : none,
                         before_s == leads_s[i] ? "\u2713" : "", true))
            *s = leads_s[i];
    }
    return *s != before_s;
}

/* Draws count-in lengths in bars of the click. Returns true if the choice has changed. */
static bool bar_items(ui *on, const live_click *click, double *s)
{
    const double before_s = *s;
    for (int bars = 1; bars <= 2; ++bars) {
        const double bars_s = bars * (double)click->bar * 60.0 / click->bpm;
        char label[64];
        (void)snprintf(label, sizeof label, "Count-in %d bar%s", bars, bars > 1 ? "s" : "");
        if (ui_menu_item(on, label, fabs(before_s - bars_s) < 1e-6 ? "\u2713" : "", true))
            *s = bars_s;
    }
    return *s != before_s;
}

static void click_items(app *of, ui *on)
{
    static const char *const label[] = {"No click", "Click in the count-in",
                                        "Click in the count-in and the recording", "Click always"};
    live_click click = app_click(of);
    for (uint32_t i = 0; i < sizeof label / sizeof label[0]; ++i)
        if (ui_menu_item(on, label[i], click.when == i ? "\u2713" : "", true)) {
            click.when = (live_click_when)i;
            app_set_click(of, &click);
        }
    if (ui_menu_item(on, "Follow external timecode", app_chases(of) ? "\u2713" : "", true))
        app_set_chases(of, !app_chases(of));
    if (ui_menu_item(on, "Tempo \u2026", "", true))
        ui_dialog_open(on, "tempo");
}

void record_menu_open(ui *on, float x, float y)
{
    ui_menu_open(on, "record_menu", x, y);
}

void record_menu_draw(app *of, ui *on)
{
    app_lead_in lead = app_lead_in_of(of);
    const live_click click = app_click(of);
    if (!ui_open_menu_begin(on, "record_menu"))
        return;
    bool is_other = lead_items(on, "Count-in", "No count-in", &lead.count_in_s);
    if (click.when != LIVE_CLICK_OFF)
        is_other |= bar_items(on, &click, &lead.count_in_s);
    ui_rule(on);
    is_other |= lead_items(on, "Pre-roll", "No pre-roll", &lead.preroll_s);
    ui_rule(on);
    click_items(of, on);
    if (is_other)
        app_set_lead_in(of, lead);
    ui_menu_end(on);
}

/* Draws the tempo dialog. Changes take effect immediately. */
void record_menu_tempo(app *of, ui *on)
{
    static const ui_range bpm_range =
                              {LIVE_CLICK_BPM_MIN, LIVE_CLICK_BPM_MAX, "bpm", 1, true, 120.0},
                          bar_range = {1.0, LIVE_CLICK_BAR_MAX, "beats", 0, false, 4.0};
    live_click click = app_click(of);
    double bar = (double)click.bar;
    if (!ui_dialog_begin(on, "tempo", "Click tempo", 420.0f))
        return;
    ui_width(on, -1.0f);
    bool is_other = ui_slider(on, "Beats per minute", 120.0f, &bpm_range, &click.bpm);
    ui_width(on, -1.0f);
    is_other |= ui_slider(on, "Beats per bar", 120.0f, &bar_range, &bar);
    click.bar = (uint32_t)floor(bar + 0.5);
    if (is_other)
        app_set_click(of, &click);
    ui_space(on, 8.0f);
    if (ui_button(on, "Close", UI_PLAIN))
        ui_dialog_close(on);
    ui_dialog_end(on);
}
