/* Any bytes are a log or are refused with a reason; what was read keeps the parser's promises. */
#include "log_parse.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size);

static void check_channels(const log_data *data)
{
    assert(data->channel_count >= 1 && data->channel_count <= MRT_MAX_CHANNELS);
    for (uint32_t i = 0; i < data->channel_count; ++i) {
        const mrt_channel *channel = &data->channel[i];
        assert(strlen(channel->name) < LOG_NAME && strlen(channel->unit) < LOG_NAME);
        assert(channel->hand <= MRT_NO_HAND);
        assert(channel->min < channel->max);
    }
}

static void check_records(const log_data *data)
{
    assert(data->record_count >= 1 && data->record_count >= data->damaged_count);
    assert(data->time_ns[0] == 0);
    for (size_t i = 1; i < data->record_count; ++i)
        assert(data->time_ns[i] >= data->time_ns[i - 1]);
    for (size_t i = 0; i < data->record_count * data->channel_count; ++i)
        assert(isfinite(data->value[i]));
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    log_data data;
    char reason[LOG_REASON];
    if (log_parse(&data, bytes, size, MRT_RIGHT, reason) < 0) {
        assert(strlen(reason) > 0 && !data.value && !data.time_ns);
    } else {
        check_channels(&data);
        check_records(&data);
    }
    log_data_finish(&data);
    return 0;
}
