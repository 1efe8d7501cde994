/* The style of HTML pages: a whole <style> element. Used within show/ only. */
#ifndef SASBENCH_REPORT_PAGE_STYLE_H
#define SASBENCH_REPORT_PAGE_STYLE_H

extern const char page_style[];

#endif
