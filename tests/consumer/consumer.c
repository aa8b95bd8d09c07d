/* Built against the installed package by tests/house/consumer.sh. */
#include <plantimeter/plantimeter.h>

#include <stdio.h>

int main(void)
{
    plm_error error = {0};
    plm_cloud cloud;
    if (plm_cloud_create(3, PLM_HAS_RGB, &cloud, &error) != PLM_OK) return fprintf(stderr, "%s\n", error.message), 1;
    const int right = cloud.count == 3 && cloud.rgb && !cloud.label;
    plm_cloud_free(&cloud);
    return right ? 0 : 1;
}
