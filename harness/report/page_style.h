/* The style of HTML pages: a whole <style> element. Used within show/ only. */
#ifndef SASBENCH_SHOW_PAGE_STYLE_H
#define SASBENCH_SHOW_PAGE_STYLE_H

extern const char page_style[];

#endif
