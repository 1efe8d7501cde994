/* The style of HTML pages and their script: whole elements. Used within show/ only. */
#ifndef SASBENCH_REPORT_PAGE_STYLE_H
#define SASBENCH_REPORT_PAGE_STYLE_H

extern const char page_style[], page_script[];

#endif
