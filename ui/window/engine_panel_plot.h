/* window/engine_panel_plot.h - the time of the last frames against the time there is: one bar a
 * frame, the period, the median and the 99th percentile. [main] */
#ifndef MAROTTE_UI_WINDOW_ENGINE_PANEL_PLOT_H
#define MAROTTE_UI_WINDOW_ENGINE_PANEL_PLOT_H
#include "stage/live.h"
#include "window/ui.h"

void engine_plot_draw(ui *on, const live_status *status, double period_ms, float height);

#endif
