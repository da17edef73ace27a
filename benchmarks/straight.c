/* A straight reduction, the way of the paper: eq. 1, 2 and 6, record by record, rates written as text.
 *
 *   straight PARAMETERS CAPTURE OUTPUT
 *
 * PARAMETERS is a text file of numbers: n, volts per count, table rate [deg/s], then n of each of polarity,
 * scale factor, bias, then H (3 x n) row by row, then Earth's part in x, y, z as constant, cosine and sine of
 * the table's angle (3 x 3). A record in which a gyro did not answer is left out. No flags, no checks, no
 * datasets, no fit: what a laboratory's own program does in an afternoon.
 *
 * FORMAT is how a number is written; ours are doubles, so all their digits unless compiled otherwise.
 */
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#ifndef FORMAT
#define FORMAT "%.15e"
#endif

#define MOST_GYROS 64
#define HEADER_BYTES 64

static double number(FILE *file)
{
    double value;
    if (fscanf(file, "%lf", &value) != 1) {
        fprintf(stderr, "straight: too few parameters\n");
        exit(2);
    }
    return value;
}

static FILE *opened(const char *path, const char *mode)
{
    FILE *file = fopen(path, mode);
    if (!file) {
        perror(path);
        exit(2);
    }
    return file;
}

int main(int count, char **arguments)
{
    double polarity[MOST_GYROS], scale[MOST_GYROS], bias[MOST_GYROS], projection[3][MOST_GYROS];
    double earth[3][3], rates[MOST_GYROS];
    struct {
        uint32_t time[2], pulse;
        int32_t counts[MOST_GYROS];
    } record;
    char header[HEADER_BYTES];

    if (count != 4) {
        fprintf(stderr, "usage: straight PARAMETERS CAPTURE OUTPUT\n");
        return 2;
    }
    FILE *parameters = opened(arguments[1], "r");
    int n = (int)number(parameters);
    if (n < 1 || n > MOST_GYROS)
        return 2;
    double volts_per_count = number(parameters), table_rate = number(parameters);
    for (int i = 0; i < n; i++)
        polarity[i] = number(parameters);
    for (int i = 0; i < n; i++)
        scale[i] = number(parameters);
    for (int i = 0; i < n; i++)
        bias[i] = number(parameters);
    for (int axis = 0; axis < 3; axis++)
        for (int i = 0; i < n; i++)
            projection[axis][i] = number(parameters);
    for (int axis = 0; axis < 3; axis++)
        for (int k = 0; k < 3; k++)
            earth[axis][k] = number(parameters);
    fclose(parameters);

    FILE *capture = opened(arguments[2], "rb"), *output = opened(arguments[3], "w");
    if (fread(header, 1, HEADER_BYTES, capture) != HEADER_BYTES)
        return 2;
    const double radians = acos(-1.0) / 180.0;
    const size_t bytes = 12 + 4 * (size_t)n;
    while (fread(&record, 1, bytes, capture) == bytes) {
        int missing = 0;
        for (int i = 0; i < n; i++) {
            missing |= record.counts[i] == INT32_MIN;
            double volts = record.counts[i] * volts_per_count;
            rates[i] = (polarity[i] * volts - bias[i]) / scale[i];              /* eq. 1 */
        }
        if (missing)
            continue;
        double time = (record.time[0] + 4294967296.0 * record.time[1]) / 1e6;
        double angle = table_rate * time * radians;
        double cosine = cos(angle), sine = sin(angle);
        fprintf(output, FORMAT, time);
        for (int axis = 0; axis < 3; axis++) {
            double rate = 0;
            for (int i = 0; i < n; i++)
                rate += projection[axis][i] * rates[i];                         /* eq. 2 */
            rate -= earth[axis][0] + earth[axis][1] * cosine + earth[axis][2] * sine; /* eq. 6 */
            fprintf(output, " " FORMAT, rate);
        }
        fputc('\n', output);
    }
    return fclose(output) ? 1 : 0;
}
