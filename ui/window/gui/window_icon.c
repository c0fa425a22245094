#include "window/gui/window_icon.h"

#include "base/installed.h"

#include <png.h>
#include <stdio.h>
#include <stdlib.h>

static bool read_icon(window_icon *out, uint32_t size_px)
{
    char file[128], path[INSTALLED_LENGTH];
    png_image image = {.version = PNG_IMAGE_VERSION};
    (void)snprintf(file, sizeof file, "../icons/hicolor/%ux%u/apps/org.marotte.Marotte.png",
                   size_px, size_px);
    *out = (window_icon){.size_px = size_px};
    if (!installed_data(path, file) || !png_image_begin_read_from_file(&image, path))
        return false;
    image.format = PNG_FORMAT_RGBA;
    if (image.width == size_px && image.height == size_px)
        out->rgba = malloc(PNG_IMAGE_SIZE(image));
    if (out->rgba && !png_image_finish_read(&image, NULL, out->rgba, 0, NULL)) {
        free(out->rgba);
        out->rgba = NULL;
    }
    png_image_free(&image);
    return out->rgba != NULL;
}

uint32_t window_icons_read(window_icon out[WINDOW_ICONS])
{
    static const uint32_t sizes_px[WINDOW_ICONS] = {16, 32, 48, 128};
    uint32_t count = 0;
    for (int i = 0; i < WINDOW_ICONS; ++i)
        count += read_icon(&out[count], sizes_px[i]) ? 1 : 0;
    return count;
}

void window_icons_finish(window_icon *icon, uint32_t count)
{
    for (uint32_t i = 0; i < count; ++i)
        free(icon[i].rgba);
}
